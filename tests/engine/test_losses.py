import signal
from dataclasses import dataclass

import pytest

from panokit.engine import Loss, Quarantine
from panokit.errors import PanokitError, Rejection

CRASH = Loss(reason="died", exit_code=-signal.SIGSEGV)
KILL = Loss(reason="died", exit_code=-signal.SIGKILL)


@dataclass(frozen=True)
class Item:
    item: str
    stage: str = "expand"


def until_rejected(quarantine, loss, item=Item("a")):
    for tries in range(1, 100):
        verdict = quarantine(item, loss)
        if isinstance(verdict, Rejection):
            return tries, verdict
        assert verdict is item
    raise AssertionError("never given up")


def test_an_item_is_given_up_after_so_many_crashes_and_says_who_it_is():
    tries, rejection = until_rejected(Quarantine(), CRASH)
    assert tries == 3
    assert (rejection.item, rejection.stage) == ("a", "expand")
    assert rejection.reason == "crashes-worker"
    assert "SIGSEGV" in rejection.message


def test_kills_from_outside_are_forgiven_more_often_than_crashes():
    assert until_rejected(Quarantine(), KILL)[0] == 8
    unknown = Loss(reason="died", exit_code=None)
    assert until_rejected(Quarantine(), unknown)[0] == 8
    told_late = Loss(reason="died", exit_code=None, times=4)
    assert until_rejected(Quarantine(), told_late)[0] == 2


def test_an_item_that_hangs_is_another_reason():
    rejection = until_rejected(Quarantine(), Loss(reason="silent", exit_code=-9))[1]
    assert rejection.reason == "hangs-worker"


def test_losses_of_other_items_do_not_count():
    quarantine = Quarantine(most_losses=2)
    a, b = Item("a"), Item("a", stage="stitch")
    assert quarantine(a, CRASH) is a
    assert quarantine(b, CRASH) is b


def test_a_rejection_is_the_same_however_often_the_worker_was_killed():
    quarantine = Quarantine()
    for _ in range(5):
        quarantine(Item("a"), KILL)
    assert until_rejected(quarantine, CRASH)[1] == until_rejected(Quarantine(), CRASH)[1]


def test_workers_that_die_before_they_begin_end_the_run():
    quarantine = Quarantine()
    loss = Loss(reason="died", exit_code=1, has_begun=False)
    quarantine(Item("a"), loss)
    quarantine(Item("a"), loss)
    with pytest.raises(PanokitError, match="before they begin"):
        quarantine(Item("a"), loss)


def test_one_item_after_the_other_is_no_items_fault_unless_some_are_done_in_between():
    quarantine = Quarantine(most_losses=1)
    for n in range(20):
        loss = Loss(reason="died", exit_code=1, finished=n // 7)
        assert isinstance(quarantine(Item(f"i{n}"), loss), Rejection)
    with pytest.raises(PanokitError, match="8 items in a row"):
        for n in range(20, 30):
            quarantine(Item(f"i{n}"), Loss(reason="died", exit_code=1, finished=3))

import os
from pathlib import Path

import pytest

from panokit.engine import LocalEngine, SerialEngine, attempt, make_engine
from panokit.errors import ItemError, PanokitError, Rejection, UsageError
from panokit.records import Receipt


def receipt(item: str) -> Receipt:
    return Receipt(item=item, stage="test", path=Path(item), key=str(os.getpid()))


def work(item: str) -> Receipt:
    def do() -> Receipt:
        if item == "bad":
            raise ItemError("It is bad.", reason="bad")
        if item == "broken":
            raise PanokitError("The disk is gone.")
        return receipt(item)

    return attempt(item, "test", do)


def die(item: str) -> Receipt:
    os._exit(1)


@pytest.mark.parametrize("engine", [SerialEngine(), LocalEngine(2)])
def test_bad_items_are_outcomes_and_the_others_go_on(engine):
    items = [f"i{n}" for n in range(9)] + ["bad"]
    outcomes = list(engine.run(work, items))
    assert {outcome.item for outcome in outcomes} == set(items)
    assert [o.reason for o in outcomes if isinstance(o, Rejection)] == ["bad"]


def test_a_broken_run_is_not_an_outcome():
    with pytest.raises(PanokitError, match="disk"):
        list(SerialEngine().run(work, ["broken"]))


def test_the_local_engine_uses_other_processes_and_bounds_what_is_in_flight():
    taken = []

    def items():
        for n in range(12):
            taken.append(n)
            yield f"i{n}"

    outcomes = LocalEngine(2, window=3).run(work, items())
    first = next(outcomes)
    assert first.key != str(os.getpid())
    assert len(taken) <= 6
    assert len(list(outcomes)) == 11


def test_a_dead_worker_is_explained():
    with pytest.raises(PanokitError, match="worker process died"):
        list(LocalEngine(1).run(die, ["a"]))


def test_engines_by_name():
    assert isinstance(make_engine("serial"), SerialEngine)
    assert make_engine("local", 3).workers == 3
    with pytest.raises(UsageError, match="serial or local"):
        make_engine("ray")

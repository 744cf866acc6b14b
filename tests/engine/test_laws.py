"""What holds for every engine."""

import os
import random
import signal
import time
from pathlib import Path

import pytest

from panokit.engine import Quarantine, attempt, make_engine, report
from panokit.errors import ItemError, MissingExtraError, PanokitError, Rejection
from panokit.records import Receipt

WORKERS, WINDOW = 2, 4


class Told:
    """An engine whose listeners can be exchanged, so that a cluster serves all tests."""

    def __init__(self, name):
        self.heard, self.listen, self.lose = [], None, None
        self.engine = make_engine(name, WORKERS, on_report=self.hear, on_loss=self.decide)

    def hear(self, value):
        self.heard.append(value)
        if self.listen is not None:
            self.listen(value)

    def decide(self, item, loss):
        return self.lose(item, loss)

    def run(self, task, items):
        return self.engine.run(task, items)


# Clusters beside everything else once hung the tests: they have a run of their own (test-slow).
WITH_WORKERS = ["local", pytest.param("dask", marks=pytest.mark.slow)]


@pytest.fixture(scope="module", params=["serial", *WITH_WORKERS])
def shared(request):
    told = Told(request.param)
    yield told
    told.engine.close()


@pytest.fixture
def told(shared):
    shared.heard.clear()
    shared.listen, shared.lose = None, Quarantine(most_losses=2, most_kills=2)
    return shared


# Of engines that have processes of their own.
several = pytest.mark.parametrize("shared", WITH_WORKERS, indirect=True, scope="module")


def receipt(item: str) -> Receipt:
    return Receipt(item=item, stage="test", path=Path(item), key=str(os.getpid()))


def work(item: str) -> Receipt:
    def do() -> Receipt:
        report(("begun", item))
        if item == "bad":
            raise ItemError("It is bad.", reason="bad")
        if item == "missing":
            raise MissingExtraError("mitsuba", "render", "Rendering")
        if item == "zero":
            raise ZeroDivisionError("by zero")
        return receipt(item)

    return attempt(item, "test", do)


def test_outcomes_are_the_same_in_any_order_and_reports_are_heard(told):
    items = [f"i{n}" for n in range(20)] + ["bad"]
    outcomes = list(told.run(work, items))
    assert sorted(outcome.item for outcome in outcomes) == sorted(items)
    assert [o.reason for o in outcomes if isinstance(o, Rejection)] == ["bad"]
    assert sorted(told.heard) == sorted(("begun", item) for item in items)


def test_items_are_taken_no_faster_than_they_are_done(told):
    taken = 0

    def items():
        nonlocal taken
        for n in range(25):
            taken += 1
            yield f"i{n}"

    done = 0
    for _ in told.run(work, items()):
        # What is under way, and what was done in the same moment as this one.
        assert taken <= done + 2 * WINDOW
        done += 1
    assert done == taken == 25


def test_a_run_that_nobody_wants_more_of_leaves_the_engine_usable(told):
    outcomes = told.run(work, (f"i{n}" for n in range(99)))
    next(outcomes)
    outcomes.close()
    assert [outcome.item for outcome in told.run(work, ["again"])] == ["again"]


@pytest.mark.parametrize(
    ("item", "kind", "text"),
    [("missing", PanokitError, "panokit\\[render\\]"), ("zero", ZeroDivisionError, "by zero")],
)
def test_what_a_task_raises_ends_the_run(told, item, kind, text):
    with pytest.raises(kind, match=text):
        list(told.run(work, [item]))


def look_around(path: Path) -> Receipt:
    here = path.read_text()
    threads = os.environ.get("OMP_NUM_THREADS")
    return Receipt(item=here, stage="test", path=path, key=str(threads))


@several
def test_relative_paths_mean_the_same_and_a_worker_has_one_thread(told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("note").write_text("here")
    (outcome,) = told.run(look_around, [Path("note")])
    assert (outcome.item, outcome.key) == ("here", "1")


def opencv_threads(item: str) -> Receipt:
    import cv2

    return Receipt(item=item, stage="test", path=Path(item), key=str(cv2.getNumThreads()))


def test_opencv_has_one_thread_so_that_sums_are_the_same_everywhere(told):
    (outcome,) = told.run(opencv_threads, ["a"])
    assert outcome.key == "1"


def record(target: Path) -> Receipt:
    """Works for a while and then writes its record, at once, unless it is there."""
    if not target.exists():
        report(os.getpid())
        time.sleep(0.3)
        part = target.with_suffix(f".{os.getpid()}.part")
        part.write_text(target.name)
        os.link(part, target)  # fails if the record is there: work that was done twice
    return receipt(target.name)


@several
def test_workers_killed_at_random_lose_nothing_and_repeat_nothing(told, tmp_path):
    chance, killed = random.Random(5), []

    def kill(pid):
        if len(killed) < 3 and chance.random() < 0.4:
            killed.append(pid)
            os.kill(pid, signal.SIGKILL)

    told.listen, told.lose = kill, Quarantine()
    targets = [tmp_path / f"{n}.record" for n in range(12)]
    outcomes = list(told.run(record, targets))
    assert len(killed) == 3
    assert sorted(o.item for o in outcomes) == sorted(target.name for target in targets)
    assert all(isinstance(outcome, Receipt) for outcome in outcomes)
    assert all(target.read_text() == target.name for target in targets)


def die_of_one(item: str) -> Receipt:
    if item == "poison":
        os._exit(3)
    return receipt(item)


@several
def test_an_item_that_ends_its_worker_every_time_is_left_out(told):
    items = ["a", "poison", "b", "c", "d", "e"]
    outcomes = list(told.run(die_of_one, items))
    assert sorted(outcome.item for outcome in outcomes) == sorted(items)
    (rejection,) = [o for o in outcomes if isinstance(o, Rejection)]
    assert (rejection.item, rejection.reason) == ("poison", "crashes-worker")
    assert "--retry-rejected" in rejection.message

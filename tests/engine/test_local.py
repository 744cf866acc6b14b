import multiprocessing
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from panokit.engine import LocalEngine, Quarantine, SerialEngine, attempt, make_engine, report
from panokit.errors import ItemError, MissingExtraError, PanokitError, Rejection, UsageError
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

    outcomes = LocalEngine(2).run(work, items())
    first = next(outcomes)
    assert first.key != str(os.getpid())
    assert len(taken) <= 3
    assert len(list(outcomes)) == 11


def test_items_that_end_their_workers_one_after_the_other_end_the_run():
    quarantine = Quarantine(most_losses=1)
    with pytest.raises(PanokitError, match="8 items in a row ended their workers, h the last"):
        list(LocalEngine(1, on_loss=quarantine).run(die, "abcdefghi"))


def die_once(path: Path) -> Receipt:
    if path.suffix == ".kills" and not path.exists():
        path.touch()
        report("about to die")
        os.kill(os.getpid(), signal.SIGKILL)
    return receipt(path.name)


def test_a_lost_item_is_run_again_and_the_others_go_on(tmp_path):
    losses = []

    def try_again(item, loss):
        losses.append((item.name, loss))
        return item

    names = ["a", "b.kills", "c", "d.kills", "e"]
    engine = LocalEngine(2, on_loss=try_again)
    outcomes = list(engine.run(die_once, [tmp_path / name for name in names]))
    assert sorted(outcome.item for outcome in outcomes) == names
    assert sorted(name for name, _ in losses) == ["b.kills", "d.kills"]
    assert {loss.reason for _, loss in losses} == {"died"}
    assert {loss.exit_code for _, loss in losses} == {-signal.SIGKILL}
    assert {loss.last_report for _, loss in losses} == {"about to die"}


def hang(item: str) -> Receipt:
    if item == "hangs":
        # As a renderer that is stuck in C would: no exception reaches it.
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
        report(child.pid)
        time.sleep(60)
    for beat in range(10 if item == "slow" else 0):
        report(f"beat {beat}")
        time.sleep(0.5)
    return receipt(item)


def test_a_silent_worker_is_ended_with_its_children_and_a_reporting_one_is_not():
    losses = []

    def leave_out(item, loss):
        losses.append((item, loss))
        return f"instead of {item}"

    engine = LocalEngine(2, silence_s=2.5, on_loss=leave_out)
    started = time.monotonic()
    outcomes = list(engine.run(hang, ["hangs", "slow", "c"]))
    assert time.monotonic() - started < 55
    assert sorted(o.item for o in outcomes) == ["c", "instead of hangs", "slow"]
    ((item, loss),) = losses
    assert (item, loss.reason) == ("hangs", "silent")
    assert not _is_alive(loss.last_report)


def test_workers_are_replaced_after_so_many_items():
    items = [f"i{n}" for n in range(7)]
    outcomes = list(LocalEngine(1, items_per_worker=3).run(work, items))
    processes = [outcome.key for outcome in outcomes]
    assert [processes.count(process) for process in dict.fromkeys(processes)] == [3, 3, 1]


def tell(item: str) -> Receipt:
    report(("halfway", item))
    return receipt(item)


@pytest.mark.parametrize("kind", [SerialEngine, LocalEngine])
def test_reports_reach_the_driver(kind):
    heard = []
    list(kind(on_report=heard.append).run(tell, ["a", "b"]))
    assert sorted(heard) == [("halfway", "a"), ("halfway", "b")]
    report("nobody listens")


def fail(item: str) -> Receipt:
    if item == "extra":
        raise MissingExtraError("mitsuba", "render", "Rendering")
    if item == "local":

        class LocalError(Exception):
            pass

        raise LocalError("of a class that cannot be sent")
    raise ZeroDivisionError("by zero")


@pytest.mark.parametrize(
    ("item", "kind", "text"),
    [
        ("extra", PanokitError, "panokit[render]"),
        ("local", PanokitError, "LocalError: of a class that cannot be sent"),
        ("zero", ZeroDivisionError, "by zero"),
    ],
)
def test_what_a_worker_raises_reaches_the_caller(item, kind, text):
    with pytest.raises(kind, match=re.escape(text)) as caught:
        list(LocalEngine(1).run(fail, [item]))
    if item == "extra":
        assert caught.value.exit_code == MissingExtraError.exit_code
    if item == "zero":
        assert "in fail" in caught.value.__notes__[0]


def test_no_process_is_left_when_nobody_wants_more():
    outcomes = LocalEngine(2).run(work, [f"i{n}" for n in range(99)])
    next(outcomes)
    outcomes.close()
    assert multiprocessing.active_children() == []


_SLEEPERS = """
import os, time
from panokit.engine import LocalEngine

def sleep(item):
    print(os.getpid(), flush=True)
    time.sleep(60)

if __name__ == "__main__":
    list(LocalEngine(2).run(sleep, range(2)))
"""


def _is_alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z"
    except OSError:
        return False


def test_workers_do_not_outlive_a_killed_run(tmp_path):
    script = tmp_path / "sleepers.py"
    script.write_text(_SLEEPERS)
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE) as process:
        workers = [int(process.stdout.readline()) for _ in range(2)]
        process.send_signal(signal.SIGKILL)
    deadline = time.monotonic() + 20
    while any(map(_is_alive, workers)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(map(_is_alive, workers))


def test_engines_by_name():
    assert isinstance(make_engine("serial"), SerialEngine)
    assert make_engine("local", 3).workers == 3
    with pytest.raises(UsageError, match="choose serial, local, dask, slurm, or the address"):
        make_engine("ray")


@pytest.mark.parametrize("name", ["local", "dask", "tcp://far:8786"])
def test_no_workers_do_nothing(name):
    with pytest.raises(UsageError, match="0 workers do nothing"):
        make_engine(name, 0)

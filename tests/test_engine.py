import os
import signal
import subprocess
import sys
import time
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
    with pytest.raises(UsageError, match="serial or local"):
        make_engine("ray")

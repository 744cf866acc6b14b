import os
import signal
import subprocess
import sys
import time

import pytest

# Started again by every worker, as a program's main module is; the pause stands for slow imports.
_DRIVER = """
import sys, time
from pathlib import Path
from panokit.engine import make_engine
from panokit.records import Receipt
if __name__ == "__mp_main__":
    Path(sys.argv[1], "starting").touch()
    time.sleep(1)
def work(item):
    return Receipt(item=item, stage="test", path=Path(item), key=item)
if __name__ == "__main__":
    try:
        list(make_engine(sys.argv[2], 2).run(work, ["a", "b", "c"]))
    except KeyboardInterrupt:
        sys.exit("interrupted")
"""


def interrupt_while_starting(tmp_path, driver: str, *arguments: str) -> tuple[int, str]:
    script = tmp_path / "driver.py"
    script.write_text(driver)
    process = subprocess.Popen(
        [sys.executable, script, tmp_path, *arguments], stderr=subprocess.PIPE, text=True,
        start_new_session=True,
        # A shell starts background jobs deaf to SIGINT, and what they start inherits it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509
    )  # fmt: skip
    deadline = time.monotonic() + 120
    while not (tmp_path / "starting").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    _, told = process.communicate(timeout=120)
    return process.returncode, told


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="signals cannot be held back")
@pytest.mark.parametrize("engine", ["local", "dask"])
def test_workers_that_still_start_leave_an_interrupt_to_the_driver(tmp_path, engine):
    assert interrupt_while_starting(tmp_path, _DRIVER, engine) == (1, "interrupted\n")


# The application's worker waits for work when the interrupt comes.
_WAITING = """
import asyncio, os, sys
from pathlib import Path
from panokit.app.work import Work
async def wait(work):
    await work.in_process(os.getpid)
    Path(sys.argv[1], "starting").touch()
    await asyncio.sleep(60)
if __name__ == "__main__":
    work = Work()
    try:
        asyncio.run(wait(work))
    except KeyboardInterrupt:
        sys.exit("interrupted")
    finally:
        work.close()
"""


def test_the_worker_of_the_application_leaves_an_interrupt_to_the_driver(tmp_path):
    assert interrupt_while_starting(tmp_path, _WAITING) == (1, "interrupted\n")

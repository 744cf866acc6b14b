"""What runs in a worker process: take an item, run the task, send the outcome.

Everything goes through one pipe. To the worker: an item in a tuple, or None for the end. From it:
pairs of a word and a value. "ready" comes once, when it has started; "report" is what a task
reports; "outcome" is what a task returned, or "error" what it raised.
"""

import os
import pickle
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import parent_process
from multiprocessing.connection import Connection
from typing import Any

from panokit.engine.interrupts import leave_interrupts_to_driver
from panokit.engine.protocol import reports_to
from panokit.errors import PanokitError


def serve(pipe: "Connection[Any, Any]", task: Callable[[Any], Any]) -> None:
    """Serve a pipe until it says None or ends.

    Args:
        pipe: To the process that drives the run.
        task: What to do with each item.
    """
    _prepare()
    # Reports and outcomes come from one thread at a time, but not always from the same.
    lock = threading.Lock()

    def send(word: str, value: Any) -> None:
        with lock:
            pipe.send((word, value))

    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        send("ready", None)
        while (item := pipe.recv()) is not None:
            try:
                with reports_to(lambda value: send("report", value)):
                    outcome = task(item[0])
            except Exception as error:
                if not isinstance(error, PanokitError):
                    error.add_note(f"In a worker process:\n{traceback.format_exc()}")
                send("error", sendable(error))
            else:
                send("outcome", outcome)


def _prepare() -> None:
    """Compute with one thread, leave Ctrl-C to the driver, and end when it does."""
    leave_interrupts_to_driver()
    if hasattr(os, "setpgrp"):
        # Whatever a task starts (Blender) ends together with it: see `kill_group`.
        os.setpgrp()
    use_one_thread()
    threading.Thread(target=_end_with_parent, daemon=True).start()


def kill_group(pid: int) -> None:
    """Kill a worker and whatever it has started, now."""
    with suppress(ProcessLookupError, PermissionError):
        if hasattr(os, "killpg") and os.getpgid(pid) == pid:
            os.killpg(pid, signal.SIGKILL)
        else:
            os.kill(pid, signal.SIGKILL)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        kill_group(os.getpid())


def sendable(error: Exception) -> Exception:
    """The error itself if it survives the way to the driver, or its text."""
    try:
        copy = pickle.loads(pickle.dumps(error))
    except Exception:
        copy = None
    if type(copy) is type(error) and str(copy) == str(error):
        return error
    if isinstance(error, PanokitError):
        plain = PanokitError(str(error))
        # The exit code is the class's own, which the copy does not have.
        plain.exit_code = error.exit_code  # type: ignore[misc]
        return plain
    return PanokitError(f"{type(error).__name__}: {error}. Report it to the developers.")


def use_one_thread() -> None:
    """Let numerical libraries of this process, and of those it starts, compute with one thread."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    import cv2  # here, because it reads the environment when it is loaded

    cv2.setNumThreads(1)
    if "torch" in sys.modules:
        # Loaded with the task, before the environment said so; two such workers would fight.
        sys.modules["torch"].set_num_threads(1)

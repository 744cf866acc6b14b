"""What runs in a Dask worker: the plugin that holds the task, and the call for each item.

Of an item is told: "begun" with the address of the worker that has it, "report" with what the task
reports, and "landed" with its end: ("outcome", what it returned) or ("error", what it raised).
"""

import os
import pickle
import traceback
from collections.abc import Callable
from contextlib import chdir
from pathlib import Path
from typing import Any

from distributed import WorkerPlugin, get_worker

from panokit import __version__
from panokit.engine.dask.turns import SharedTurns
from panokit.engine.protocol import reports_to
from panokit.engine.turns import take_turns_by
from panokit.engine.worker import kill_group, sendable, use_one_thread
from panokit.errors import PanokitError, StorageError, UsageError


class Work(WorkerPlugin):
    """Brings a task to each worker once, those that come later included.

    A network that the task has loaded stays loaded, as the process does. It caps threads,
    connects the process to shared turns, and lets the worker and what it starts end together.

    Args:
        task: What to do with each item.
        topic: The run's own, for what is told while tasks run.
        folder: Where the driver is; relative paths start there.
    """

    def __init__(self, task: Callable[[Any], Any], topic: str, folder: Path) -> None:
        self.task, self.topic, self.folder = task, topic, folder
        self.version = __version__
        self.worker: Any = None

    def setup(self, worker: Any) -> None:
        """Prepare the process."""
        self.worker = worker
        if worker.nanny is not None and hasattr(os, "setpgrp"):
            # Ctrl-C is for the driver; and see `kill_worker`.
            os.setpgrp()
        use_one_thread()
        take_turns_by(SharedTurns(worker))

    def teardown(self, worker: Any) -> None:
        """Leave the process as it is for others."""
        take_turns_by(None)

    def check(self) -> None:
        """Find out whether this worker can do what the driver wants.

        Raises:
            UsageError: If it runs another version of panokit.
            StorageError: If it does not have the driver's files.
        """
        if self.version != __version__:
            raise UsageError(
                f"The worker {self.worker.address} has panokit {__version__}, this is "
                f"{self.version}. Install the same version there."
            )
        if not self.folder.is_dir():
            raise StorageError(
                f"The worker {self.worker.address} has no folder {self.folder}. Workers and "
                "driver share files: start both on a file system that all of them have."
            )


def perform(topic: str, key: str, item: Any) -> None:
    """Run the task of a run on an item and tell what came out.

    It is told and not returned: what a worker returns is lost with the worker, and then made anew
    on others, for as long as there are any.
    """
    worker = get_worker()

    def tell(word: str, value: Any) -> None:
        worker.log_event(topic, pickle.dumps((key, word, value)))

    tell("begun", worker.address)
    end: tuple[str, Any]
    try:
        work = worker.plugins.get(topic)
        if not isinstance(work, Work):
            raise PanokitError(
                f"The worker {worker.address} could not load the task. Install the same packages "
                "there as here."
            )
        work.check()
        with chdir(work.folder), reports_to(lambda value: tell("report", value)):
            end = "outcome", work.task(item)
    except Exception as error:
        if not isinstance(error, PanokitError):
            error.add_note(f"In a worker process:\n{traceback.format_exc()}")
        end = "error", sendable(error)
    tell("landed", end)


def kill_worker(dask_worker: Any) -> None:
    """Kill the worker of a nanny, which then starts another, and whatever the worker started."""
    if dask_worker.process is not None and dask_worker.process.pid is not None:
        kill_group(dask_worker.process.pid)

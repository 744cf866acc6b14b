"""Run one task over many items: in this process, or in several.

An engine takes a picklable task and items, keeps a bounded number of them in flight, and
hands back each outcome as it comes. Tasks write files and return receipts, never arrays, and
must be safe to run twice. What a task raises ends the run; a bad item is an outcome.
"""

import os
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from itertools import islice
from multiprocessing import get_context, parent_process
from typing import Protocol, TypeVar

from panokit.errors import ItemError, PanokitError, Rejection, UsageError
from panokit.records import Receipt

Outcome = Receipt | Rejection
Item = TypeVar("Item")


class Engine(Protocol):
    """Maps a task over items."""

    def run(self, task: Callable[[Item], Outcome], items: Iterable[Item]) -> Iterator[Outcome]:
        """The outcome of each item, in the order in which they come."""
        ...


class SerialEngine:
    """One item after the other in this process: nothing to set up, and a debugger works."""

    def run(self, task: Callable[[Item], Outcome], items: Iterable[Item]) -> Iterator[Outcome]:
        """The outcome of each item, in the order of the items."""
        for item in items:
            yield task(item)


class LocalEngine:
    """Several processes on this machine.

    Args:
        workers: How many; each computes with one thread.
        window: How many items are in flight at most; twice the workers if not given.
    """

    def __init__(self, workers: int | None = None, window: int | None = None) -> None:
        self.workers = workers or available_cores()
        self.window = window or 2 * self.workers
        if self.workers < 1 or self.window < 1:
            raise UsageError("A local engine needs at least one worker and one item in flight.")

    def run(self, task: Callable[[Item], Outcome], items: Iterable[Item]) -> Iterator[Outcome]:
        """The outcome of each item, as they are done.

        Raises:
            PanokitError: If a worker dies, for instance because memory ran out.
        """
        queue = iter(items)
        # spawn, not fork: renderers and thread pools do not survive a fork.
        with ProcessPoolExecutor(
            self.workers, mp_context=get_context("spawn"), initializer=_prepare_worker
        ) as pool:
            pending: set[Future[Outcome]] = {
                pool.submit(task, item) for item in islice(queue, self.window)
            }
            try:
                while pending:
                    done, pending = wait(pending, return_when=FIRST_COMPLETED)
                    for future in done:
                        yield future.result()
                    pending |= {pool.submit(task, item) for item in islice(queue, len(done))}
            except BrokenProcessPool as error:
                raise PanokitError(
                    "A worker process died, most likely because memory ran out. What was done "
                    "is kept: run the same command again with fewer workers."
                ) from error
            finally:
                for future in pending:
                    future.cancel()


def make_engine(name: str, workers: int | None = None) -> Engine:
    """The engine with this name: "serial" or "local"."""
    if name == "serial":
        return SerialEngine()
    if name == "local":
        return LocalEngine(workers)
    raise UsageError(f"There is no engine {name!r}; choose serial or local.")


def attempt(item: str, stage: str, work: Callable[[], Receipt]) -> Outcome:
    """Do the work on one item; what is wrong with the item becomes a `Rejection`."""
    try:
        return work()
    except ItemError as error:
        return Rejection.from_error(item, stage, error)


def available_cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _prepare_worker() -> None:
    """Compute with one thread, and end when the driving process does, however it ends."""
    _use_one_thread()
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _use_one_thread() -> None:
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    import cv2  # here, because it reads the environment when it is loaded

    cv2.setNumThreads(1)

"""Work that takes longer than a blink, away from the loop that answers the browser.

What is mostly Python goes to a worker process; what is mostly NumPy, OpenCV or ONNX Runtime, and
what belongs to one tab's state, to a thread. Errors come back in words.
"""

import asyncio
import logging
import re
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context
from typing import Any, ParamSpec, TypeVar

from panokit.app.desks import TAB_FOLDERS
from panokit.engine.interrupts import interrupts_held_back, leave_interrupts_to_driver
from panokit.errors import ItemError, PanokitError

P = ParamSpec("P")
T = TypeVar("T")
_LOGGER = logging.getLogger(__name__)
_THREADS = 4
_KEPT_AT = re.compile(rf"\S*[/\\]{TAB_FOLDERS}[^/\\\s]*[/\\](?:\S*[/\\])?")


class Work:
    """The worker process and the threads of the application.

    Args:
        processes: How many worker processes; they are started when they are first needed.
    """

    def __init__(self, processes: int = 1) -> None:
        self._processes = processes
        self._pool: ProcessPoolExecutor | None = None
        self._threads = ThreadPoolExecutor(_THREADS, thread_name_prefix="panokit-app")

    async def in_process(
        self, function: Callable[P, T], *arguments: P.args, **named: P.kwargs
    ) -> T:
        """Call a function of a module in the worker process.

        Raises:
            PanokitError: As the function raises it, or if the worker ends.
        """
        if self._pool is None:
            # Spawned, not forked: the loop, its threads and ONNX Runtime do not survive a fork.
            self._pool = ProcessPoolExecutor(
                self._processes,
                mp_context=get_context("spawn"),
                initializer=leave_interrupts_to_driver,
            )
        pool, call = self._pool, partial(_carried, function, *arguments, **named)
        try:
            with interrupts_held_back():  # the worker is started here
                outcome_to_be = asyncio.get_running_loop().run_in_executor(pool, call)
            outcome = await outcome_to_be
        except BrokenProcessPool as error:
            if self._pool is pool:
                self._pool = None
                pool.shutdown(wait=False)
            raise PanokitError(
                "The worker ended before it was done, most likely for want of memory. Try a "
                "smaller picture, or close other programs."
            ) from error
        if isinstance(outcome, _Failed):
            raise outcome.error()
        return outcome

    async def in_thread(self, function: Callable[P, T], *arguments: P.args, **named: P.kwargs) -> T:
        """Call a function in a thread."""
        call = partial(function, *arguments, **named)
        return await asyncio.get_running_loop().run_in_executor(self._threads, call)

    def close(self) -> None:
        """End the worker and the threads; what they are at is not waited for."""
        if self._pool is not None:
            for process in list((self._pool._processes or {}).values()):
                process.terminate()
            self._pool.shutdown(wait=False, cancel_futures=True)
        self._threads.shutdown(wait=False, cancel_futures=True)


class _Failed:
    """An error on its way from the worker: not every error of ours can be pickled."""

    def __init__(self, error: PanokitError) -> None:
        self.kind = type(error)
        self.message = str(error)
        self.reason = error.reason if isinstance(error, ItemError) else ""

    def error(self) -> PanokitError:
        """The error, of its class where that takes a message alone."""
        if issubclass(self.kind, ItemError):
            return self.kind(self.message, reason=self.reason)
        try:
            return self.kind(self.message)
        except TypeError:
            return PanokitError(self.message)


def _carried(function: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
    try:
        return function(*arguments, **named)
    except PanokitError as error:
        return _Failed(error)


def in_words(error: BaseException) -> str:
    """What to tell the user of an error; one that panokit did not foresee goes to the log too."""
    if isinstance(error, PanokitError):
        # Where a dropped file is kept says nothing to whoever dropped it.
        return _KEPT_AT.sub("", str(error))
    if isinstance(error, MemoryError):
        return "There is not enough memory for this. Try a smaller picture or a narrower map."
    _LOGGER.error("unexpected error", exc_info=error)
    return (
        f"Something went wrong that panokit did not foresee ({type(error).__name__}: {error}). "
        "The terminal has more; you can go on with something else."
    )

"""What an engine is, and the one that works in this process."""

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, Protocol, TypeVar

from panokit.errors import ItemError, Rejection
from panokit.records import Receipt

Outcome = Receipt | Rejection
Item = TypeVar("Item")
Listener = Callable[[Any], None]
_LISTENER: ContextVar[Listener | None] = ContextVar("listener", default=None)


class Engine(Protocol):
    """Maps a task over items."""

    def run(self, task: Callable[[Item], Outcome], items: Iterable[Item]) -> Iterator[Outcome]:
        """The outcome of each item, in the order in which they come."""
        ...

    def close(self) -> None:
        """Give back what is held between runs, such as a cluster's workers."""
        ...


class SerialEngine:
    """One item after the other in this process: nothing to set up, and a debugger works.

    Args:
        on_report: Gets what tasks `report`.
    """

    def __init__(self, *, on_report: Listener | None = None) -> None:
        self._on_report = on_report

    def run(self, task: Callable[[Item], Outcome], items: Iterable[Item]) -> Iterator[Outcome]:
        """The outcome of each item, in the order of the items."""
        for item in items:
            with reports_to(self._on_report), _one_opencv_thread():
                outcome = task(item)
            yield outcome

    def close(self) -> None:
        """Nothing is held."""


@contextmanager
def _one_opencv_thread() -> Iterator[None]:
    """Some of OpenCV's sums depend on how many threads share them: here as in all workers, one."""
    import cv2  # here, because a run without items needs it not

    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)


def report(value: Any) -> None:
    """Tell the process that drives the run how far this task is; a sign of life, too.

    Args:
        value: Small and picklable. Where nobody listens, nothing happens.
    """
    listener = _LISTENER.get()
    if listener is not None:
        listener(value)


@contextmanager
def reports_to(listener: Listener | None) -> Iterator[None]:
    """Let `report` in this block reach a listener."""
    token = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def attempt(item: str, stage: str, work: Callable[[], Receipt]) -> Outcome:
    """Do the work on one item; what is wrong with the item becomes a `Rejection`."""
    try:
        return work()
    except ItemError as error:
        return Rejection.from_error(item, stage, error)


def available_cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1

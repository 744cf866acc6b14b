"""Several processes on this machine; one that dies, hangs or grows is replaced.

Each worker has a pipe of its own and at most one item, so it is always known which item a
lost worker had. Workers are spawned, not forked: renderers and thread pools do not survive
a fork.
"""

import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import Any, Literal

from panokit.engine.protocol import Item, Listener, Outcome, available_cores
from panokit.engine.worker import kill_group, serve
from panokit.errors import PanokitError, UsageError

_GOODBYE_S = 10.0
# A process that starts imports much; on a busy machine that takes a while.
_START_S = 120.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """A worker that was lost with an item in hand.

    Attributes:
        reason: "died", or "silent": it was killed because nothing was heard of it for too long.
        exit_code: Of the process; negative for a signal.
        last_report: What its task reported last about this item, or None.
    """

    reason: Literal["died", "silent"]
    exit_code: int | None
    last_report: Any = None


class LocalEngine:
    """Several processes on this machine, each computing with one thread.

    Args:
        workers: How many; one for each core if not given.
        items_per_worker: A worker is replaced by a fresh one after so many items, for renderers
            that do not give back memory; never if not given.
        silence_s: A worker that neither ends its item nor reports for so long is killed;
            it may take as long as it likes if not given.
        on_report: Gets what tasks report.
        on_loss: Gets the item of a lost worker, and returns the item to run in its place: the
            same to try again, or one that leaves out what is to blame. If not given, a lost
            worker ends the run.
    """

    def __init__(
        self,
        workers: int | None = None,
        *,
        items_per_worker: int | None = None,
        silence_s: float | None = None,
        on_report: Listener | None = None,
        on_loss: Callable[[Any, Loss], Any] | None = None,
    ) -> None:
        self.workers = available_cores() if workers is None else workers
        self._items_per_worker = items_per_worker
        self._silence_s = silence_s
        self._on_report = on_report
        self._on_loss = on_loss or _end_the_run
        if self.workers < 1:
            raise UsageError("A local engine needs at least one worker.")

    def run(self, task: Callable[[Item], Outcome], items: Iterable[Item]) -> Iterator[Outcome]:
        """The outcome of each item, as they are done.

        Raises:
            PanokitError: If a worker dies and nothing else is agreed for that.
        """
        queue, again = iter(items), deque[Item]()
        crew: list[_Worker] = []
        try:
            while True:
                while len(crew) < self.workers:
                    item = again.popleft() if again else next(queue, None)
                    if item is None:
                        break
                    worker = _Worker(task)
                    crew.append(worker)
                    worker.give(item)
                busy = [worker for worker in crew if worker.item is not None]
                if not busy:
                    break
                for worker in _ready(busy, self._silence_s):
                    yield from self._hear(worker, again)
                for worker in [worker for worker in crew if worker.item is None]:
                    item = None
                    if not worker.is_done(self._items_per_worker):
                        item = again.popleft() if again else next(queue, None)
                    if item is None:
                        crew.remove(worker)
                        worker.dismiss()
                    else:
                        worker.give(item)
        finally:
            for worker in crew:
                worker.kill()

    def _hear(self, worker: "_Worker", again: "deque[Any]") -> Iterator[Outcome]:
        """Take in what a worker has sent, or find out that it is lost."""
        message = worker.next_message()
        while message is not None:
            word, value = message
            if word == "error":
                raise value
            if word == "outcome":
                worker.rest()
                yield value
                return
            if word == "report":
                worker.last_report = value
                if self._on_report is not None:
                    self._on_report(value)
            message = worker.next_message()
        if worker.is_gone or worker.patience_s(self._silence_s) <= 0:
            reason: Literal["died", "silent"] = "died" if worker.is_gone else "silent"
            worker.kill()
            loss = Loss(reason=reason, exit_code=worker.exit_code, last_report=worker.last_report)
            again.append(self._on_loss(worker.item, loss))
            worker.rest()
            worker.is_gone = True


def _end_the_run(item: Any, loss: Loss) -> Any:
    raise PanokitError(
        "A worker process died, most likely because memory ran out. What was done "
        "is kept: run the same command again with fewer workers."
    )


class _Worker:
    """One process, the pipe to it, and the item that it has."""

    def __init__(self, task: Callable[[Any], Any]) -> None:
        context = get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs, task), daemon=True)
        self._process.start()
        theirs.close()  # so that the pipe ends when the process does
        self.item: Any = None
        self.last_report: Any = None
        self.is_gone = False
        self._items = 0
        self._is_ready = False
        self._heard = time.monotonic()

    @property
    def exit_code(self) -> int | None:
        """How the process ended."""
        return self._process.exitcode

    @property
    def channels(self) -> "list[Connection[Any, Any] | int]":
        """What becomes ready when there is something to hear of this worker."""
        return [self.pipe, self._process.sentinel]

    def give(self, item: Any) -> None:
        """Let the worker begin with an item."""
        self.item, self.last_report = item, None
        self._items += 1
        self._heard = time.monotonic()
        try:
            self.pipe.send((item,))
        except OSError:
            self.is_gone = True

    def next_message(self) -> tuple[str, Any] | None:
        """What the worker has sent, if it has; notes when the worker is gone."""
        try:
            if not self.pipe.poll():
                if not self._process.is_alive():
                    # It may have spoken between our two questions.
                    self.is_gone = not self.pipe.poll()
                    return None if self.is_gone else self.next_message()
                return None
            message: tuple[str, Any] = self.pipe.recv()
        except (EOFError, OSError):
            self.is_gone = True
            return None
        self._heard = time.monotonic()
        self._is_ready = True
        return message

    def patience_s(self, silence_s: float | None) -> float:
        """How much longer the worker may be silent; while it starts, that is more."""
        if silence_s is None:
            return float("inf")
        allowed = silence_s if self._is_ready else max(silence_s, _START_S)
        return allowed - (time.monotonic() - self._heard)

    def rest(self) -> None:
        """Nothing in hand."""
        self.item = None

    def is_done(self, items_per_worker: int | None) -> bool:
        """Whether this worker gets no more items."""
        return self.is_gone or (items_per_worker is not None and self._items >= items_per_worker)

    def dismiss(self) -> None:
        """Let the process end in its own time."""
        if self.is_gone:
            return
        try:
            self.pipe.send(None)
            self._process.join(_GOODBYE_S)
        except OSError:
            pass
        self.kill()

    def kill(self) -> None:
        """End the process and all that it has started, now."""
        if self._process.pid is not None and self._process.is_alive():
            kill_group(self._process.pid)
        self._process.join()
        self.pipe.close()


def _ready(busy: "list[_Worker]", silence_s: float | None) -> "list[_Worker]":
    """Wait until something is to be heard of some workers; those, and any that are silent."""
    patience_s = min(worker.patience_s(silence_s) for worker in busy)
    left = None if silence_s is None else max(0.0, patience_s)
    owners = {channel: worker for worker in busy for channel in worker.channels}
    ready = {id(owners[channel]) for channel in wait(list(owners), left)}  # type: ignore[index]
    return [worker for worker in busy if id(worker) in ready or worker.patience_s(silence_s) <= 0]

"""Several processes on this machine; one that dies, hangs or grows is replaced.

Each worker has a pipe of its own and at most one item, so it is always known which item a
lost worker had. Workers are spawned, not forked: renderers and thread pools do not survive
a fork.
"""

import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import Any, Literal

from panokit.engine.interrupts import interrupts_held_back
from panokit.engine.losses import Loss, OnLoss, Quarantine
from panokit.engine.protocol import Item, Listener, Outcome, available_cores
from panokit.engine.worker import kill_group, serve
from panokit.errors import Rejection, UsageError

_GOODBYE_S = 10.0
# A process that starts imports much; on a busy machine that takes a while.
_START_S = 120.0


class LocalEngine:
    """Several processes on this machine, each computing with one thread.

    Args:
        workers: How many; one for each core if not given.
        items_per_worker: A worker is replaced by a fresh one after so many items, for renderers
            that do not give back memory; never if not given.
        silence_s: A worker that neither ends its item nor reports for so long is killed;
            it may take as long as it likes if not given.
        on_report: Gets what tasks report.
        on_loss: Decides on the item of a lost worker, see `OnLoss`; a `Quarantine` for each run
            if not given.
    """

    def __init__(
        self,
        workers: int | None = None,
        *,
        items_per_worker: int | None = None,
        silence_s: float | None = None,
        on_report: Listener | None = None,
        on_loss: OnLoss | None = None,
    ) -> None:
        self.workers = available_cores() if workers is None else workers
        self._items_per_worker = items_per_worker
        self._silence_s = silence_s
        self._on_report = on_report
        self._on_loss = on_loss
        if self.workers < 1:
            raise UsageError(f"{self.workers} workers do nothing. Give at least one.")

    def run(self, task: Callable[[Item], Outcome], items: Iterable[Item]) -> Iterator[Outcome]:
        """The outcome of each item, as they are done.

        Raises:
            PanokitError: If a task raises it, or if workers are lost for no item's fault.
        """
        crew = _Crew(task, iter(items), self._on_loss or Quarantine(), self._on_report)
        try:
            while True:
                crew.fill(self.workers, self._items_per_worker)
                busy = [worker for worker in crew.workers if worker.item is not None]
                if not busy:
                    break
                outcomes: list[Outcome] = []
                for worker in _ready(busy, self._silence_s):
                    outcomes += crew.hear(worker, self._silence_s)
                # First the next items, so that workers go on while the caller deals with these.
                crew.fill(self.workers, self._items_per_worker)
                yield from outcomes
        finally:
            for worker in crew.workers:
                worker.kill()

    def close(self) -> None:
        """Nothing is held between runs."""


class _Crew:
    """The workers of one run, and what is left for them to do."""

    def __init__(
        self,
        task: Callable[[Any], Any],
        queue: Iterator[Any],
        on_loss: OnLoss,
        on_report: Listener | None,
    ) -> None:
        self.workers: list[_Worker] = []
        self._task, self._queue, self._again = task, queue, deque[Any]()
        self._on_loss, self._on_report = on_loss, on_report
        self._finished = 0

    def fill(self, wanted: int, items_per_worker: int | None) -> None:
        """Give an item to every worker that has none, and dismiss those who get no more."""
        for worker in [worker for worker in self.workers if worker.item is None]:
            item = None if worker.is_done(items_per_worker) else self._next()
            if item is None:
                self.workers.remove(worker)
                worker.dismiss()
            else:
                worker.give(item)
        while len(self.workers) < wanted:
            item = self._next()
            if item is None:
                break
            worker = _Worker(self._task)
            self.workers.append(worker)
            worker.give(item)

    def hear(self, worker: "_Worker", silence_s: float | None) -> list[Outcome]:
        """Take in what a worker has sent, or find out that it is lost."""
        message = worker.next_message()
        while message is not None:
            word, value = message
            if word == "error":
                raise value
            if word == "outcome":
                worker.rest()
                self._finished += 1
                return [value]
            if word == "report":
                worker.last_report = value
                if self._on_report is not None:
                    self._on_report(value)
            message = worker.next_message()
        if worker.is_gone or worker.patience_s(silence_s) <= 0:
            return self._lose(worker)
        return []

    def _lose(self, worker: "_Worker") -> list[Outcome]:
        reason: Literal["died", "silent"] = "died" if worker.is_gone else "silent"
        worker.kill()
        loss = Loss(
            reason=reason,
            exit_code=worker.exit_code,
            last_report=worker.last_report,
            has_begun=worker.is_ready,
            finished=self._finished,
        )
        verdict = self._on_loss(worker.item, loss)
        worker.rest()
        worker.is_gone = True
        if isinstance(verdict, Rejection):
            return [verdict]
        self._again.append(verdict)
        return []

    def _next(self) -> Any:
        return self._again.popleft() if self._again else next(self._queue, None)


class _Worker:
    """One process, the pipe to it, and the item that it has."""

    def __init__(self, task: Callable[[Any], Any]) -> None:
        context = get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs, task), daemon=True)
        with interrupts_held_back():
            self._process.start()
        theirs.close()  # so that the pipe ends when the process does
        self.item: Any = None
        self.last_report: Any = None
        self.is_gone = False
        self._items = 0
        self.is_ready = False
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
        self.is_ready = True
        return message

    def patience_s(self, silence_s: float | None) -> float:
        """How much longer the worker may be silent; while it starts, that is more."""
        if silence_s is None:
            return float("inf")
        allowed = silence_s if self.is_ready else max(silence_s, _START_S)
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

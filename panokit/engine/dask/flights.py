"""One run on a cluster: items are sent a few at a time, and landed, or lost and sent again."""

import logging
import pickle
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, Literal
from uuid import uuid4

from distributed import KilledWorker

from panokit.engine.dask.clusters import Cluster, lost_scheduler
from panokit.engine.dask.work import Work, perform
from panokit.engine.losses import Loss, OnLoss
from panokit.engine.protocol import Listener, Outcome
from panokit.engine.settings import ClusterSettings
from panokit.errors import PanokitError, Rejection

_log = logging.getLogger("panokit.engine")
_LOOK_S = 5.0
# An item that was on so many lost workers, nobody knows whether as the one to blame, flies alone.
_MOST_UNSURE = 2


@dataclass(slots=True)
class _Flight:
    """An item that is to be sent, or under way.

    Attributes:
        item: The item.
        unsure: How many workers were lost that had it, perhaps without having begun with it.
        future: Its result, once sent.
        worker: The address of the worker that has begun with it, or "".
        last_report: What its task reported last.
        heard: When anything was last heard of it.
        is_over: Whether its task has ended; what came out is still to be heard.
    """

    item: Any
    unsure: int = 0
    future: Any = None
    worker: str = ""
    last_report: Any = None
    heard: float = field(default=0.0)
    is_over: bool = False

    @property
    def is_suspect(self) -> bool:
        """Whether it must be the only one under way."""
        return self.unsure >= _MOST_UNSURE


class Flights:
    """What is under way in one run.

    Args:
        cluster: The workers.
        task: What to do with each item.
        items: The items.
        on_report: Gets what tasks report, in the thread that asks for outcomes.
        on_loss: Decides on the item of a lost worker.
        silence_s: A worker of which nothing is heard for so long is killed.
        settings: Of the cluster.
    """

    def __init__(
        self,
        cluster: Cluster,
        task: Callable[[Any], Any],
        items: Iterator[Any],
        *,
        on_report: Listener | None,
        on_loss: OnLoss,
        silence_s: float | None,
        settings: ClusterSettings,
    ) -> None:
        self._cluster, self._client = cluster, cluster.client
        self._items, self._settings = items, settings
        self._on_report, self._on_loss = on_report, on_loss
        self._silence_s = silence_s
        self._topic = f"panokit-{uuid4().hex}"
        self._work = Work(task, self._topic, Path.cwd())
        # What other threads tell: (key, word, value).
        self._inbox: SimpleQueue[tuple[str, str, Any]] = SimpleQueue()
        self._flights: dict[str, _Flight] = {}
        self._again: deque[_Flight] = deque()
        self._suspects: deque[_Flight] = deque()
        self._numbers = count()
        self._finished = 0

    def land(self) -> Iterator[Outcome]:
        """The outcome of each item, as they are done."""
        self._client.subscribe_topic(self._topic, self._hear_event)
        self._cluster.register(self._work, self._topic)
        try:
            while True:
                self._fill()
                if not self._flights:
                    break
                outcomes = self._take_in()
                # First the next items, so that workers go on while the caller deals with these.
                self._fill()
                yield from outcomes
        except Exception as error:
            # Dask has several errors for a scheduler that is gone, some of them hard to tell.
            if self._client.status == "closed":
                raise lost_scheduler(self._cluster.address) from error
            raise
        finally:
            self._clean_up()

    def _clean_up(self) -> None:
        try:
            for flight in self._flights.values():
                flight.future.cancel(force=True)
            self._client.unsubscribe_topic(self._topic)
            self._cluster.unregister(self._topic)
        except Exception as error:  # a scheduler that is gone has forgotten all of it
            _log.debug("not cleaned up: %s", error)

    def _fill(self) -> None:
        """Send items until enough are under way."""
        while len(self._flights) < self._cluster.workers() * self._settings.in_flight:
            if self._suspects:
                if not self._flights:
                    self._send(self._suspects.popleft())
                return
            flight = self._again.popleft() if self._again else self._next()
            if flight is None:
                return
            self._send(flight)

    def _next(self) -> _Flight | None:
        item = next(self._items, None)
        return None if item is None else _Flight(item)

    def _send(self, flight: _Flight) -> None:
        key = f"{self._topic}-{next(self._numbers)}"
        flight.worker, flight.last_report, flight.is_over = "", None, False
        stage = str(getattr(flight.item, "stage", ""))
        needs = self._settings.resources.get(stage) or None
        self._cluster.check_resources(stage, needs)
        flight.future = self._client.submit(
            perform, self._topic, key, flight.item, key=key, pure=False, resources=needs
        )
        self._flights[key] = flight
        flight.future.add_done_callback(lambda _: self._inbox.put((key, "done", None)))

    def _hear_event(self, event: tuple[float, bytes]) -> None:
        """Called in the client's thread."""
        self._inbox.put(pickle.loads(event[1]))

    def _take_in(self) -> list[Outcome]:
        """Wait until something is heard, and deal with all that was."""
        try:
            messages = [self._inbox.get(timeout=self._patience_s())]
            while not self._inbox.empty():
                messages.append(self._inbox.get())
        except Empty:
            messages = []
        outcomes: list[Outcome] = []
        for key, word, value in messages:
            flight = self._flights.get(key)
            if flight is None:  # of an attempt that was given up, or has landed
                continue
            flight.heard = time.monotonic()
            if word == "landed":
                outcomes.append(self._land(key, *value))
            elif word == "done":
                if flight.future.status != "finished":
                    del self._flights[key]
                    outcomes += self._lose(flight)
                    flight.future.release()
                else:
                    flight.is_over = True
            elif word == "begun":
                flight.worker = value
            else:
                flight.last_report = value
                if self._on_report is not None:
                    self._on_report(value)
        if not messages:
            self._cluster.look()
            self._send_untold()
        return [*outcomes, *self._end_silent()]

    def _land(self, key: str, word: str, value: Any) -> Outcome:
        """The outcome that a task has told."""
        flight = self._flights.pop(key)
        flight.future.release()
        if word == "error":
            raise value
        self._finished += 1
        outcome: Outcome = value
        return outcome

    def _send_untold(self) -> None:
        """What is over, but was not told of, was told to nobody: its worker's last words."""
        for key in [key for key, flight in self._flights.items() if flight.is_over]:
            flight = self._flights.pop(key)
            flight.future.release()
            self._return(flight)

    def _lose(self, flight: _Flight) -> list[Outcome]:
        if flight.future.status in ("cancelled", "lost"):
            raise lost_scheduler(self._cluster.address)
        error = flight.future.exception()
        if not isinstance(error, KilledWorker):
            raise PanokitError(
                f"The workers cannot run the task ({type(error).__name__}: {error}). Install the "
                "same packages there as here."
            ) from error
        address = getattr(error.last_worker, "address", "")
        is_sure = flight.worker == address or flight.is_suspect
        if is_sure:
            return self._decide(flight, "died", error.allowed_failures + 1)
        flight.unsure += 1
        self._return(flight)
        return []

    def _decide(
        self, flight: _Flight, reason: Literal["died", "silent"], times: int
    ) -> list[Outcome]:
        loss = Loss(
            reason=reason, exit_code=None, last_report=flight.last_report, times=times,
            finished=self._finished,
        )  # fmt: skip
        verdict = self._on_loss(flight.item, loss)
        if isinstance(verdict, Rejection):
            return [verdict]
        flight.item = verdict
        self._return(flight)
        return []

    def _return(self, flight: _Flight) -> None:
        (self._suspects if flight.is_suspect else self._again).append(flight)

    def _end_silent(self) -> list[Outcome]:
        """Kill the workers of which nothing was heard for too long."""
        if self._silence_s is None:
            return []
        outcomes: list[Outcome] = []
        overdue = time.monotonic() - self._silence_s
        for key, flight in list(self._flights.items()):
            if flight.worker and not flight.is_over and flight.heard < overdue:
                del self._flights[key]
                # Cancelled first, so that it is not given to the worker that comes next.
                flight.future.cancel(force=True)
                self._cluster.kill(flight.worker)
                outcomes += self._decide(flight, "silent", 1)
        return outcomes

    def _patience_s(self) -> float:
        if self._silence_s is None:
            return _LOOK_S
        heard = [flight.heard for flight in self._flights.values() if flight.worker]
        left = min(heard, default=time.monotonic()) + self._silence_s - time.monotonic()
        return min(max(left, 0.01), _LOOK_S)

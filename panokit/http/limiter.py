"""Waiting one's turn: a request rate per host, and pauses that servers ask for."""

import threading
import time
from collections.abc import Callable

from panokit.engine.turns import wait_for_turn
from panokit.errors import NetworkError


class RateLimiter:
    """A token bucket per host, shared by every thread of a client.

    A pause holds back the whole host, not only the thread that was told to wait.

    Args:
        rate_per_s: Requests a second and host, in the long run.
        burst: Requests that may go at once after a quiet time.
        clock: A monotonic clock in seconds.
    """

    def __init__(
        self, rate_per_s: float, burst: int, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._rate_per_s = rate_per_s
        self._interval_s = 1.0 / rate_per_s
        self._burst = burst
        self._clock = clock
        self._next_s: dict[str, float] = {}
        self._paused_until_s: dict[str, float] = {}
        self._lock = threading.Lock()
        self._stopped = threading.Event()

    def wait(self, host: str) -> None:
        """Return when it is this caller's turn to ask this host.

        Raises:
            NetworkError: If `stop` was called.
        """
        # On a cluster, where other workers may ask the same host; else there is none to wait for.
        wait_for_turn(host, self._rate_per_s, self._burst, self._stopped)
        turn_s = self._reserve(host)
        while True:
            with self._lock:
                until_s = max(turn_s, self._paused_until_s.get(host, turn_s))
            remaining_s = until_s - self._clock()
            if self._stopped.wait(max(remaining_s, 0.0)):
                raise NetworkError("The transfer was stopped. Run again to go on from here.")
            if remaining_s <= 0:
                return

    def pause(self, host: str, seconds: float) -> None:
        """Let nobody ask this host for so long from now; a longer pause stays."""
        with self._lock:
            until_s = self._clock() + seconds
            self._paused_until_s[host] = max(until_s, self._paused_until_s.get(host, until_s))

    def sleep(self, seconds: float) -> None:
        """Wait before trying again, but wake up on `stop`."""
        self._stopped.wait(seconds)

    def stop(self) -> None:
        """Wake every waiting thread and let none pass any more."""
        self._stopped.set()

    def _reserve(self, host: str) -> float:
        """The time of this caller's turn (the virtual scheduling form of a token bucket)."""
        with self._lock:
            now_s = self._clock()
            # A full bucket is one whose next token was due `burst` intervals ago.
            earliest_s = now_s - (self._burst - 1) * self._interval_s
            turn_s = max(self._next_s.get(host, earliest_s), earliest_s)
            self._next_s[host] = turn_s + self._interval_s
            return turn_s

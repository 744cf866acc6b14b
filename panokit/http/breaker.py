"""Noticing that a whole service is down, and waiting longer for it than for one request.

One failure says little of a service, many in a row say that it is down, or that it has begun
to answer with web pages: a sign-in, a captcha, a block. Hammering on helps nobody then.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass

from panokit.errors import OutageError
from panokit.http.failures import WEB_PAGE, Failure, FailureKind
from panokit.http.policy import Policy


@dataclass(slots=True)
class _Health:
    """Of one host: failures and web pages in a row, and the pauses made so far."""

    failures: int = 0
    pages: int = 0
    pauses: int = 0
    tripped_at_s: float = float("-inf")
    outage: str = ""


class Breaker:
    """Counts failures in a row of each host; threads may share it.

    Args:
        policy: How many failures are too many, and how long the pauses are.
        clock: A monotonic clock in seconds.
    """

    def __init__(self, policy: Policy, clock: Callable[[], float]) -> None:
        self._policy = policy
        self._clock = clock
        self._hosts: dict[str, _Health] = {}
        self._lock = threading.Lock()

    def check(self, host: str) -> None:
        """Pass if the host is not given up.

        Raises:
            OutageError: If it is.
        """
        with self._lock:
            outage = self._health(host).outage
        if outage:
            raise OutageError(outage)

    def succeeded(self, host: str) -> None:
        """The host gave an answer that makes sense."""
        with self._lock:
            self._hosts[host] = _Health()

    def failed(self, host: str, failure: Failure, started_s: float) -> float | None:
        """Count a failure.

        Args:
            host: That was asked.
            failure: Only passing ones count; a quota is no outage.
            started_s: When the attempt began; one from before the last pause does not count.

        Returns:
            How long to leave the host alone if this was one too many, else None.

        Raises:
            OutageError: If all pauses were in vain. From then on `check` raises it too.
        """
        if failure.kind is not FailureKind.TRANSIENT:
            return None
        with self._lock:
            health = self._health(host)
            if started_s < health.tripped_at_s:
                return None
            health.failures += 1
            health.pages = health.pages + 1 if failure.reason == WEB_PAGE else 0
            limit = self._policy.failures_in_a_row
            # Who has paused once knows already that something is wrong.
            limit = limit if health.pauses == 0 else max(limit // 5, 1)
            if health.failures < limit and health.pages < self._policy.pages_in_a_row:
                return None
            pauses_s = self._policy.outage_pauses_s
            if health.pauses >= len(pauses_s):
                health.outage = _outage(host, failure, health.pages, sum(pauses_s))
                raise OutageError(health.outage)
            pause_s = pauses_s[health.pauses]
            health.pauses += 1
            health.failures = health.pages = 0
            health.tripped_at_s = self._clock()
            return pause_s

    def _health(self, host: str) -> _Health:
        return self._hosts.setdefault(host, _Health())


def _outage(host: str, failure: Failure, pages: int, paused_s: float) -> str:
    said = failure.message.rstrip(".")
    remedy = (
        "Open the service in a browser: it may ask to sign in, or block you."
        if pages
        else "What is fetched is kept; run again later."
    )
    return f"{host} fails again and again, also after pauses of {paused_s:.0f} s: {said}. {remedy}"

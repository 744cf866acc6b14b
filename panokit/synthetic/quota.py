"""How many requests a look-alike service still grants: by the minute and by the day."""

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

_MINUTE_S, _DAY_S = 60.0, 86_400.0


@dataclass(frozen=True, slots=True)
class Exceeded:
    """A quota that is used up.

    Attributes:
        period: "minute" or "day".
        retry_after_s: When the next request would be granted.
    """

    period: str
    retry_after_s: float


class QuotaCounter:
    """Counts the requests of one key; refused ones do not count. Threads may share it.

    Args:
        clock: A monotonic clock in seconds.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._granted_s: deque[float] = deque()
        self._lock = threading.Lock()

    def spend(self, per_minute: int | None, per_day: int | None) -> Exceeded | None:
        """Grant one request, or say which quota forbids it; None as a limit is no limit."""
        with self._lock:
            now_s = self._clock()
            while self._granted_s and self._granted_s[0] <= now_s - _DAY_S:
                self._granted_s.popleft()
            for limit, period, length_s in (
                (per_day, "day", _DAY_S),
                (per_minute, "minute", _MINUTE_S),
            ):
                if limit is None:
                    continue
                recent = [s for s in self._granted_s if s > now_s - length_s]
                if len(recent) >= limit:
                    wait_s = recent[-limit] + length_s - now_s if limit else length_s
                    return Exceeded(period, wait_s)
            self._granted_s.append(now_s)
            return None

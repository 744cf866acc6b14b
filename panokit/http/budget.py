"""How many requests, and how much money, a run may spend."""

import threading

from panokit.errors import QuotaError


class Budget:
    """Counts requests and their price; refuses the one that would exceed a limit.

    Every attempt counts, retries too: that is what servers count. Threads may share it.

    Args:
        max_requests: None for no limit.
        max_cost_usd: None for no limit.
    """

    def __init__(self, max_requests: int | None = None, max_cost_usd: float | None = None) -> None:
        self.max_requests = max_requests
        self.max_cost_usd = max_cost_usd
        self._requests = 0
        self._cost_usd = 0.0
        self._lock = threading.Lock()

    @property
    def requests(self) -> int:
        """Requests spent so far."""
        return self._requests

    @property
    def cost_usd(self) -> float:
        """US dollars spent so far, by the prices the caller named."""
        return self._cost_usd

    def spend(self, cost_usd: float = 0.0) -> None:
        """Count one request.

        Raises:
            QuotaError: If it would exceed the budget; then nothing is counted.
        """
        with self._lock:
            self._check(1, cost_usd)
            self._requests += 1
            self._cost_usd += cost_usd

    def check(self, requests: int, cost_usd: float = 0.0) -> None:
        """See whether this much is left, before starting something that half of is no use.

        Raises:
            QuotaError: If not.
        """
        with self._lock:
            self._check(requests, cost_usd)

    def _check(self, requests: int, cost_usd: float) -> None:
        if self.max_requests is not None and self._requests + requests > self.max_requests:
            raise QuotaError(
                f"The budget of {self.max_requests} requests does not reach: {self._requests} are "
                f"spent and the next step needs {requests}. What is fetched is kept; run again "
                "with a larger max_requests to go on."
            )
        # Half a micro-dollar of slack, so that sums of prices meet their limit exactly.
        total_usd = self._cost_usd + cost_usd
        if self.max_cost_usd is not None and total_usd > self.max_cost_usd + 5e-7:
            raise QuotaError(
                f"The budget of {self.max_cost_usd:.2f} USD does not reach: {self._cost_usd:.3f} "
                f"are spent and the next step costs {cost_usd:.3f}. What is fetched is kept; run "
                "again with a larger max_cost_usd to go on."
            )

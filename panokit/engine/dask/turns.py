"""Turns shared by all workers of a scheduler, as leases of a semaphore that it keeps."""

import logging
import threading
from typing import Any

from distributed import Semaphore

_log = logging.getLogger("panokit.engine")
# So that who no longer wants a turn need not wait long for hearing that.
_PATIENCE_S = 1.0


class SharedTurns:
    """Gives out turns: of `burst` leases each is kept for as long as `burst` turns may take.

    So no more than `burst` requests go in any `burst / rate_per_s` seconds, from all workers
    together. The leases of a worker that dies come back after the scheduler's lease timeout.

    Args:
        worker: The Dask worker of this process.
    """

    def __init__(self, worker: Any) -> None:
        self._worker = worker
        self._semaphores: dict[str, Any] = {}
        self._lock = threading.Lock()

    def __call__(self, host: str, rate_per_s: float, burst: int, stopped: threading.Event) -> None:
        """Return when it is our turn to ask this host, or when `stopped` is set."""
        semaphore = self._semaphore(host, rate_per_s, burst)
        while not stopped.is_set():
            if semaphore.acquire(timeout=_PATIENCE_S):
                timer = threading.Timer(burst / rate_per_s, _release, (semaphore,))
                timer.daemon = True
                timer.start()
                return

    def _semaphore(self, host: str, rate_per_s: float, burst: int) -> Any:
        # Leases of another rate are others: the scheduler holds a semaphore to its first limit.
        name = f"panokit {host} {burst} {rate_per_s:g}"
        with self._lock:
            if name not in self._semaphores:
                self._semaphores[name] = Semaphore(
                    max_leases=burst,
                    name=name,
                    scheduler_rpc=self._worker.scheduler,
                    loop=self._worker.loop,
                )
            return self._semaphores[name]


def _release(semaphore: Any) -> None:
    try:
        semaphore.release()
    except Exception as error:  # the scheduler or the worker is gone, and the lease with it
        _log.debug("a lease was not given back: %s", error)

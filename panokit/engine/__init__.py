"""Run one task over many items: in this process, or in several.

An engine takes a picklable task and items, keeps a bounded number of them in flight, and
hands back each outcome as it comes. Tasks write files and return receipts, never arrays, and
must be safe to run twice. What a task raises ends the run; a bad item is an outcome.

protocol  `Engine`, `SerialEngine`, `attempt`, `report`
local     `LocalEngine`: processes on this machine that are replaced when they die or hang
worker    what runs in such a process
"""

from panokit.engine.local import LocalEngine, Loss
from panokit.engine.protocol import (
    Engine,
    Outcome,
    SerialEngine,
    attempt,
    available_cores,
    report,
    reports_to,
)
from panokit.errors import UsageError

__all__ = [
    "Engine",
    "LocalEngine",
    "Loss",
    "Outcome",
    "SerialEngine",
    "attempt",
    "available_cores",
    "make_engine",
    "report",
    "reports_to",
]


def make_engine(name: str, workers: int | None = None) -> Engine:
    """The engine with this name: "serial" or "local"."""
    if name == "serial":
        return SerialEngine()
    if name == "local":
        return LocalEngine(workers)
    raise UsageError(f"There is no engine {name!r}; choose serial or local.")

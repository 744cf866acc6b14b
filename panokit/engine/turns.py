"""Waiting for one's turn among all workers of a run, as to ask a host that allows so much.

Each process has limits of its own. Where several share a host, an engine that connects them
installs a taker of turns here; in all other processes there is nothing to wait for.
"""

from collections.abc import Callable
from threading import Event

# (host, rate_per_s, burst, stopped) -> waits until it is our turn, or stopped
TurnTaker = Callable[[str, float, int, Event], None]
_taker: TurnTaker | None = None


def wait_for_turn(host: str, rate_per_s: float, burst: int, stopped: Event) -> None:
    """Return when no more than `rate_per_s` requests a second reach a host from all workers.

    Args:
        host: Whom to ask.
        rate_per_s: Requests a second, in the long run.
        burst: Requests that may go at once after a quiet time.
        stopped: Set by who no longer wants a turn.
    """
    if _taker is not None:
        _taker(host, rate_per_s, burst, stopped)


def take_turns_by(taker: TurnTaker | None) -> None:
    """Let turns in this process be given out by this, or by nobody."""
    global _taker  # noqa: PLW0603
    _taker = taker

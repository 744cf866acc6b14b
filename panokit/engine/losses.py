"""What becomes of an item whose worker was lost: it is tried again, and given up in the end."""

import signal
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from panokit.errors import PanokitError, Rejection

CRASHES, HANGS = "crashes-worker", "hangs-worker"
# So many items given up in a row, none done in between, are no items' fault.
_MOST_IN_A_ROW = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """A worker that was lost with an item in hand.

    Attributes:
        reason: "died", or "silent": it was killed because nothing was heard of it for too long.
        exit_code: Of the process; negative for a signal, None where nobody knows.
        last_report: What its task reported last about this item, or None.
        has_begun: Whether the task had begun; if not, the item can hardly be to blame.
        times: How many workers were lost before anybody was told.
        finished: How many items the run had finished by then.
    """

    reason: Literal["died", "silent"]
    exit_code: int | None
    last_report: Any = None
    has_begun: bool = True
    times: int = 1
    finished: int = 0


# Gets the item of a lost worker. Returns the item to run in its place: the same to try again, or
# one that leaves out what is to blame; or the rejection that ends it.
OnLoss = Callable[[Any, Loss], Any]


class Quarantine:
    """Tries an item again whose worker was lost, and rejects it if that happens again and again.

    A worker that was killed from outside (by the system for want of memory, by an impatient
    person, by a queue) says less about its item than one that crashed, so more such losses are
    forgiven. Items say who they are by `item` and `stage`, if they can.

    Args:
        most_losses: Crashes and silences of one item.
        most_kills: Losses of one item by SIGKILL, or for a reason that nobody knows.
    """

    def __init__(self, most_losses: int = 3, most_kills: int = 8) -> None:
        self._most_losses, self._most_kills = most_losses, most_kills
        self._losses: Counter[tuple[str, str]] = Counter()
        self._kills: Counter[tuple[str, str]] = Counter()
        self._starts: Counter[tuple[str, str]] = Counter()
        self._in_a_row = 0
        self._finished = 0

    def __call__(self, item: Any, loss: Loss) -> Any:
        """The item, to try again, or its rejection.

        Raises:
            PanokitError: If it is not the item's fault: workers die before they begin, or one
                item after the other ends its worker.
        """
        name, stage = str(getattr(item, "item", item)), str(getattr(item, "stage", ""))
        who = (stage, name)
        is_kill = loss.reason == "died" and loss.exit_code in (None, -signal.SIGKILL)
        if not loss.has_begun:
            self._starts[who] += loss.times
            if self._starts[who] >= (self._most_kills if is_kill else self._most_losses):
                raise PanokitError(
                    "Worker processes die before they begin (in a script of your own, run this "
                    'below `if __name__ == "__main__":`; else look for a lack of memory). What '
                    "was done is kept."
                )
            return item
        counts, most = (
            (self._kills, self._most_kills) if is_kill else (self._losses, self._most_losses)
        )
        counts[who] += loss.times
        if counts[who] < most:
            return item
        self._in_a_row = self._in_a_row + 1 if loss.finished == self._finished else 1
        self._finished = loss.finished
        if self._in_a_row >= _MOST_IN_A_ROW:
            raise PanokitError(
                f"{self._in_a_row} items in a row ended their workers, {name} the last: rather the "
                "installation or a lack of memory than the items. What was done is kept: run the "
                "same command again, with fewer workers or more memory for each."
            )
        return _rejection(name, stage, loss)


def _rejection(name: str, stage: str, loss: Loss) -> Rejection:
    if loss.reason == "silent":
        how, reason = "nothing was heard of its worker for too long", HANGS
    else:
        how, reason = f"its worker died ({_cause(loss.exit_code)})", CRASHES
    # How often is chance where workers are killed from outside, so it says nothing of that.
    return Rejection(
        item=name,
        stage=stage,
        reason=reason,
        message=f"Left out, because {how} again and again. Look at the item, give workers more "
        "memory, then run again with --retry-rejected.",
    )


def _cause(exit_code: int | None) -> str:
    if exit_code is None:
        return "it crashed, was killed, or memory ran out"
    if exit_code == -signal.SIGKILL:
        return "killed: most likely memory ran out"
    if exit_code < 0:
        try:
            return f"signal {signal.Signals(-exit_code).name}"
        except ValueError:
            return f"signal {-exit_code}"
    return f"exit code {exit_code}"

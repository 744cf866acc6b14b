"""What a run tells: to the person who watches, to failures.jsonl, and in numbers at its end."""

import json
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from panokit.console import Tick
from panokit.dataset.production.attempts import SampleEvent
from panokit.errors import PanokitError
from panokit.io.files import storage_error

# So many samples or workers in a row that came to nothing are no accident.
_MOST_IN_VAIN = 12


@dataclass(slots=True)
class Progress:
    """Takes in what workers report.

    Attributes:
        failures: Where attempts that gave no sample are noted.
        seed_of: (index, attempt) -> seed, to repeat one.
        tick: Counts a sample.
        rejected: Reason -> attempts.
        done: How many samples were made.
        missing: How many could not be made.
        cpu_s: Processor time of the done ones.
        bytes: Size of the done ones.
    """

    failures: Path
    seed_of: Callable[[int, int], Any]
    tick: Tick
    rejected: Counter[str] = field(default_factory=Counter)
    done: int = 0
    missing: int = 0
    cpu_s: float = 0.0
    bytes: int = 0
    _in_vain: "deque[str]" = field(default_factory=deque)

    def hear(self, event: SampleEvent) -> None:
        """Take in one event.

        Raises:
            PanokitError: If one sample after the other comes to nothing.
            StorageError: If it cannot be noted.
        """
        if event.kind == "started":
            return
        if event.kind == "done":
            self.done += 1
            self.cpu_s += event.cpu_s
            self.bytes += event.bytes
            self._in_vain.clear()
            self.tick()
            return
        self._note(event)
        if event.kind == "missing":
            self.missing += 1
            self.tick(rejected=True)
            self._vain(f"{event.reason}")
        else:
            self.rejected[event.reason] += 1

    def lose(self, event: SampleEvent) -> None:
        """Note a worker that was lost, or an attempt that is given up because of it."""
        self._note(event)
        self._vain(event.message)

    def _vain(self, why: str) -> None:
        self._in_vain.append(why)
        if len(self._in_vain) >= _MOST_IN_VAIN:
            reasons = ", ".join(
                f"{n} x {text}" for text, n in Counter(self._in_vain).most_common(3)
            )
            raise PanokitError(
                f"{_MOST_IN_VAIN} times in a row no sample came of it: {reasons}. What was done is "
                f"kept; {self.failures} tells more."
            )

    def _note(self, event: SampleEvent) -> None:
        line = {
            "index": event.index,
            "attempt": event.attempt,
            "seed": list(self.seed_of(event.index, event.attempt)),
            "kind": event.kind,
            "reason": event.reason,
            "message": event.message,
        }
        if event.traceback:
            line["traceback"] = event.traceback
        try:
            with self.failures.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line, ensure_ascii=False) + "\n")
        except OSError as error:
            raise storage_error("write", self.failures, error) from error

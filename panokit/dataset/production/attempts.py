"""One sample, however many attempts it takes."""

import time
import traceback
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from panokit.dataset.production.maker import SampleMaker
from panokit.dataset.sample import Sample
from panokit.engine import report
from panokit.errors import ItemError, PanokitError, UsageError
from panokit.io.files import storage_error

MOST_ATTEMPTS = 20
# A sample whose attempts end their workers so often is left out.
MOST_LOST_ATTEMPTS = 3
Lost = Mapping[tuple[int, int], str]


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleEvent:
    """Something that happened to a sample; what workers report.

    Attributes:
        kind: "started": an attempt begins. "rejected": it gave no usable sample. "failed": it
            raised what nobody foresaw. "done". "missing": no attempt was left.
        index: Of the sample.
        attempt: From 0.
        reason: A short stable code.
        message: One line for a person.
        traceback: Of a failure.
        seconds: How long the sample took, all attempts together.
        cpu_s: The same in processor time of this process.
        bytes: Of a done sample.
    """

    kind: Literal["started", "rejected", "failed", "done", "missing"]
    index: int
    attempt: int = 0
    reason: str = ""
    message: str = ""
    traceback: str = ""
    seconds: float = 0.0
    cpu_s: float = 0.0
    bytes: int = 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Made:
    """What became of a sample.

    Attributes:
        sample: The sample, or None if no attempt gave one.
        missing: Why there is none, or "".
        rejected: Reason -> how many attempts gave none.
    """

    sample: Sample | None
    missing: str
    rejected: Mapping[str, int]


def make_with_attempts(maker: SampleMaker, index: int, lost: Lost) -> Made:
    """Make sample `index`: attempt after attempt until one is usable.

    Args:
        maker: Makes samples.
        index: Of the sample.
        lost: (index, attempt) -> why: attempts that are not to be tried, because they ended or
            stopped their worker.

    Raises:
        PanokitError: If something is wrong that other samples will meet, too.
    """
    started, cpu_started = time.monotonic(), time.process_time()
    rejected: Counter[str] = Counter()
    own_losses = [reason for (one, _), reason in lost.items() if one == index]
    reason = own_losses[-1] if own_losses else ""
    tries = 0 if len(own_losses) >= MOST_LOST_ATTEMPTS else MOST_ATTEMPTS
    for attempt in range(tries):
        if (index, attempt) in lost:
            reason = lost[index, attempt]
            rejected[reason] += 1
            continue
        report(SampleEvent(kind="started", index=index, attempt=attempt))
        try:
            sample = maker.make(index, attempt)
        except ItemError as error:
            reason = error.reason
            rejected[reason] += 1
            _report(index, attempt, "rejected", reason, error)
        except PanokitError as error:
            # What else panokit raises on purpose is a condition of the run; but an object that
            # does not fit the cameras is a wrong argument only to them.
            if not isinstance(error, UsageError):
                raise
            reason = "usage"
            rejected[reason] += 1
            _report(index, attempt, "failed", reason, error)
        except MemoryError as error:
            raise PanokitError(
                "Memory ran out. What was done is kept: run the same command again with fewer "
                "workers."
            ) from error
        except OSError as error:
            raise storage_error("write", Path(error.filename or "a sample"), error) from error
        except Exception as error:
            reason = type(error).__name__
            rejected[reason] += 1
            _report(index, attempt, "failed", reason, error)
        else:
            report(
                SampleEvent(
                    kind="done", index=index, attempt=attempt,
                    seconds=time.monotonic() - started,
                    cpu_s=time.process_time() - cpu_started,
                    bytes=sum(map(len, sample.members.values())),
                )
            )  # fmt: skip
            return Made(sample=sample, missing="", rejected=rejected)
    report(SampleEvent(kind="missing", index=index, reason=reason))
    return Made(sample=None, missing=reason, rejected=rejected)


def _report(
    index: int, attempt: int, kind: Literal["rejected", "failed"], reason: str, error: Exception
) -> None:
    trace = traceback.format_exc() if kind == "failed" else ""
    report(
        SampleEvent(
            kind=kind, index=index, attempt=attempt, reason=reason,
            message=str(error), traceback=trace,
        )
    )  # fmt: skip

"""How far a run is, looked at from outside, while it goes on or after it."""

from collections import Counter
from dataclasses import asdict, dataclass
from typing import Any

from panokit.errors import PanokitError, UsageError
from panokit.fetch.where import total_wanted
from panokit.io.lock import holder_of
from panokit.ledger import Ledger, Pace
from panokit.pipeline.runner import LOCK
from panokit.pipeline.serving import served_asks
from panokit.pipeline.settings import MODEL_STAGES, PipelineSettings
from panokit.records import RunFolder


@dataclass(frozen=True, slots=True, kw_only=True)
class StageStatus:
    """How far one stage is.

    Attributes:
        stage: The stage.
        done: Items that are done.
        waiting: Items that came through the stage before and are neither done nor rejected;
            None where nobody knows.
        rejected: Reason -> items.
        per_hour: How fast it goes, or went when it last had something to do; None if unknown.
        left_s: How long the waiting ones take at that rate; None if unknown.
    """

    stage: str
    done: int
    waiting: int | None
    rejected: dict[str, int]
    per_hour: float | None
    left_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunStatus:
    """How far a run is.

    Attributes:
        folder: Of the run.
        driver: Who drives it now, "" if nobody does.
        stages: In order.
    """

    folder: str
    driver: str
    stages: tuple[StageStatus, ...]

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return asdict(self)


def run_status(settings: PipelineSettings) -> RunStatus:
    """How far the run of a pipeline is; nothing is changed by looking.

    Raises:
        UsageError: If it has not begun.
    """
    run = RunFolder(settings.folder())
    if not (run.root / "run.json").is_file():
        raise UsageError(f"There is no run in {run.root} yet. Start it without --status.")
    ledger = Ledger(run.ledger)
    done = {stage: count for stage, (count, _, _) in ledger.counts().items()}
    paces = ledger.paces()
    rejected: dict[str, Counter[str]] = {}
    for one in ledger.rejections():
        rejected.setdefault(one.stage, Counter())[one.reason] += 1
    stages: list[StageStatus] = []
    expected = _fetch_wanted(settings, run, done.get("fetch", 0))
    for stage in settings.stages():
        own = done.get(stage, 0)
        if stage in MODEL_STAGES:
            expected = _made_by(stage, settings)
        # What fetch rejects is replaced by something else.
        refused = rejected.get(stage, Counter())
        out = own + (0 if stage == "fetch" else sum(refused.values()))
        waiting = None if expected is None else max(expected - out, 0)
        per_hour = _rate(paces.get(stage))
        stages.append(
            StageStatus(
                stage=stage,
                done=own,
                waiting=waiting,
                rejected=dict(sorted(refused.items())),
                per_hour=per_hour,
                left_s=waiting * 3600 / per_hour if waiting and per_hour else None,
            )
        )
        expected = own
    return RunStatus(folder=str(run.root), driver=holder_of(run.root, LOCK), stages=tuple(stages))


def _fetch_wanted(settings: PipelineSettings, run: RunFolder, done: int) -> int | None:
    """How many panoramas are wanted; those that are there where fetching is finished."""
    if (run.root / "fetch.json").is_file():
        return done
    try:
        counts = [total_wanted(ask) for ask in served_asks(settings)]
    except PanokitError:
        return None
    return None if None in counts else sum(count or 0 for count in counts)


def _made_by(stage: str, settings: PipelineSettings) -> int:
    arms = len(settings.dataset.arms) if settings.dataset else 0
    return arms if stage in ("dataset", "train") else 1


def _rate(pace: Pace | None) -> float | None:
    if pace is None or pace.fresh == 0 or pace.seconds <= 0:
        return None
    return round(pace.fresh / pace.seconds * 3600, 1)

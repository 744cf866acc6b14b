"""A whole run: fetch, stitch, inpaint, expand, judge, keep. Each stage skips what is complete."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from panokit.console import Console
from panokit.engine import Engine, make_engine
from panokit.errors import Rejection, UsageError
from panokit.pipeline.batch import BatchResult, run_batch
from panokit.pipeline.fetching import fetch_batch, forget_rejections
from panokit.pipeline.inputs import run_tasks
from panokit.pipeline.judging import judge_run, keep_run
from panokit.pipeline.settings import PipelineSettings
from panokit.records import RunFolder
from panokit.settings import Settings

STAGES = ("fetch", "stitch", "inpaint", "expand", "qa", "probes")


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult:
    """What became of a run.

    Attributes:
        run: Its folder.
        batches: One for each stage that ran, in order.
    """

    run: RunFolder
    batches: tuple[BatchResult, ...] = field(default=())

    @property
    def report(self) -> Path | None:
        """The report, if the run came that far."""
        report = self.run.qa / "report.html"
        return report if report.exists() else None

    @property
    def rejections(self) -> tuple[Rejection, ...]:
        """Everything that was rejected, stage by stage."""
        return tuple(r for batch in self.batches for r in batch.rejections)

    @property
    def nothing_to_do(self) -> bool:
        """Whether everything was complete before this run began."""
        return not any(batch.fresh for batch in self.batches)

    @property
    def rejected_share(self) -> float:
        """Rejected items over all items that were looked at."""
        items = {r.item for batch in self.batches for r in batch.receipts}
        rejected = {rejection.item for rejection in self.rejections}
        return len(rejected) / max(1, len(items | rejected))


def run_pipeline(
    settings: PipelineSettings,
    console: Console,
    *,
    stop_after: str | None = None,
    retry_rejected: bool = False,
) -> RunResult:
    """Take a pipeline's places all the way to light probes, or go on where it stopped.

    Args:
        settings: What to do.
        console: Says how it goes.
        stop_after: The last stage to run; all if not given.
        retry_rejected: Try items again that an earlier run rejected.

    Raises:
        UsageError: If `stop_after` is not a stage.
        PanokitError: If the run cannot go on; what is done is kept.
    """
    if stop_after is not None and stop_after not in STAGES:
        raise UsageError(f"There is no stage {stop_after!r}; the stages are {', '.join(STAGES)}.")
    run = RunFolder(settings.folder()).create()
    run.remove_leftovers()
    run.write_settings(settings.model_dump(mode="json", exclude={"output"}))
    if retry_rejected:
        forget_rejections(run)
    run.log("start", name=settings.name)
    steps = _steps(settings, run, console)
    last = STAGES.index(stop_after) if stop_after else len(STAGES) - 1
    batches: list[BatchResult] = []
    for stage in STAGES[: last + 1]:
        batches.append(steps[stage](batches))
    run.write_manifest(_manifest(batches))
    run.log("end", stages={batch.stage: batch.summary() for batch in batches})
    return RunResult(run=run, batches=tuple(batches))


def _steps(
    settings: PipelineSettings, run: RunFolder, console: Console
) -> dict[str, Callable[[Sequence[BatchResult]], BatchResult]]:
    engine = make_engine(settings.engine, settings.workers)

    def work(stage: str, own: Settings) -> Callable[[Sequence[BatchResult]], BatchResult]:
        return lambda earlier: _work(stage, own, run, console, engine, earlier)

    return {
        "fetch": lambda _: fetch_batch(settings.fetch, run, console),
        "stitch": work("stitch", settings.stitch),
        "inpaint": work("inpaint", settings.inpaint),
        "expand": work("expand", settings.expand),
        "qa": lambda earlier: judge_run(settings, run, console, earlier),
        "probes": lambda earlier: keep_run(settings, run, console, earlier),
    }


def _work(
    stage: str,
    settings: Settings,
    run: RunFolder,
    console: Console,
    engine: Engine,
    earlier: Sequence[BatchResult],
) -> BatchResult:
    # Only what came through the stage before: a file left by other settings is not this run's.
    passed = {receipt.item for receipt in earlier[-1].receipts}
    tasks = [task for task in run_tasks(stage, run, settings) if task.item in passed]
    return run_batch(stage, tasks, console, engine=engine, run=run)


def _manifest(batches: Sequence[BatchResult]) -> list[dict[str, Any]]:
    """One row for each item: the key of each stage it went through, or where it ended."""
    rows: dict[str, dict[str, Any]] = {}
    for batch in batches:
        for receipt in batch.receipts:
            row = rows.setdefault(receipt.item, {"item": receipt.item, "stages": {}})
            row["stages"][batch.stage] = receipt.key
        for rejection in batch.rejections:
            row = rows.setdefault(rejection.item, {"item": rejection.item, "stages": {}})
            row["rejected"] = rejection.to_json()
    return [rows[item] for item in sorted(rows)]

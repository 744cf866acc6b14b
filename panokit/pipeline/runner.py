"""A whole run: from places to probes and on to models. Each stage skips what is complete."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

from panokit.console import Console
from panokit.engine import Engine, make_engine
from panokit.errors import RecordError, UsageError
from panokit.io.files import read_json, write_json
from panokit.io.lock import only_process
from panokit.ledger import Ledger
from panokit.pipeline.batch import BatchResult, run_batch
from panokit.pipeline.beforehand import check_beforehand
from panokit.pipeline.fetching import fetch_batch, forget_rejections
from panokit.pipeline.inputs import run_tasks
from panokit.pipeline.judging import judge_run, keep_run
from panokit.pipeline.result import RunResult
from panokit.pipeline.serving import served_asks, serving
from panokit.pipeline.settings import MODEL_STAGES, PipelineSettings
from panokit.records import RunFolder
from panokit.settings import Settings

LOCK = ".run.lock"
Batches = Mapping[str, BatchResult]


def run_pipeline(
    settings: PipelineSettings,
    console: Console,
    *,
    stop_after: str | None = None,
    retry_rejected: bool = False,
) -> RunResult:
    """Take a pipeline's places all the way to probes or models, or go on where it stopped.

    Args:
        settings: What to do.
        console: Says how it goes.
        stop_after: The last stage to run; all if not given.
        retry_rejected: Try items again that an earlier run rejected.

    Raises:
        UsageError: If `stop_after` is not a stage of the pipeline, another process runs it, or a
            folder that it reads is not there.
        MissingExtraError: If a stage needs a package that is not installed.
        NetworkError: If there is no scheduler.
        StorageError: If the run's folder or the library cannot be written.
        PanokitError: If the run cannot go on; what is done is kept.
    """
    stages = stages_up_to(settings, stop_after)
    check_beforehand(settings, stages)
    run = RunFolder(settings.folder()).create()
    with only_process(run.root, LOCK, "running a pipeline in"):
        return _run(settings, run, console, stages, retry_rejected=retry_rejected)


def stages_up_to(settings: PipelineSettings, stop_after: str | None) -> tuple[str, ...]:
    """The stages of a pipeline, up to one of them.

    Raises:
        UsageError: If it has no such stage.
    """
    stages = settings.stages()
    if stop_after is None:
        return stages
    if stop_after not in stages:
        raise UsageError(f"There is no stage {stop_after!r}; the stages are {', '.join(stages)}.")
    return stages[: stages.index(stop_after) + 1]


def _run(
    settings: PipelineSettings,
    run: RunFolder,
    console: Console,
    stages: Sequence[str],
    *,
    retry_rejected: bool,
) -> RunResult:
    run.remove_leftovers()
    run.mend_log()
    run.write_settings(settings.model_dump(mode="json", exclude={"output"}))
    ledger = Ledger(run.ledger)
    if not ledger.exists:
        ledger.rebuild(run.events())
    if retry_rejected:
        forget_rejections(run)
    run.log("start", name=settings.name)
    batches: dict[str, BatchResult] = {}
    seconds: dict[str, float] = {}
    with closing(make_engine(settings.engine, settings.workers, settings.cluster)) as engine:
        steps = _steps(settings, run, console, engine)
        for stage in stages:
            started = time.monotonic()
            batch = batches[stage] = steps[stage](batches)
            seconds[stage] = time.monotonic() - started
            ledger.settle(stage, batch.receipts, batch.rejections)
            _log_models(run, stage, batch)
    result = RunResult(run=run, batches=tuple(batches.values()))
    if not result.nothing_to_do:
        run.remove_leftovers()  # of workers that were lost on the way
    run.write_manifest(_manifest(result.batches))
    told = {batch.stage: batch.summary() for batch in result.batches}
    run.log("end", stages=told, seconds={s: round(t, 3) for s, t in seconds.items()})
    if not result.nothing_to_do or not (run.root / "report.html").exists():
        from panokit.pipeline.reporting import write_run_report

        write_run_report(settings, result, seconds)
    if settings.publish and tuple(stages) == settings.stages():
        _publish(settings, result, batches, console)
    return result


def _publish(
    settings: PipelineSettings, result: RunResult, batches: Batches, console: Console
) -> None:
    """Publish what is new; a run that is finished and published hashes nothing again."""
    run, record = result.run, result.run.root / "published.json"
    if result.nothing_to_do and _published_at(record) == settings.publish:
        return
    from panokit.pipeline.publishing import publish_run

    sent = publish_run(run, run.root / settings.library, settings.publish, batches, console)
    write_json(record, {"url": settings.publish})
    console.note(f"publish: {sent} files sent to {settings.publish}")


def _published_at(record: Path) -> str:
    """Where the record says that a run was published; "" if it says nothing."""
    try:
        return str(read_json(record)["url"])
    except (RecordError, KeyError, TypeError):
        return ""


def _log_models(run: RunFolder, stage: str, batch: BatchResult) -> None:
    """What `run_batch` does for pictures: the log is what a lost ledger is made anew from."""
    for receipt in batch.receipts:
        if stage in MODEL_STAGES and receipt.fresh:
            times = {"seconds": round(receipt.seconds, 3), "cpu_s": round(receipt.cpu_s, 3)}
            run.log("done", stage=stage, item=receipt.item, key=receipt.key, **times)


def _steps(
    settings: PipelineSettings, run: RunFolder, console: Console, engine: Engine
) -> dict[str, Callable[[Batches], BatchResult]]:
    def fetched(_: Batches) -> BatchResult:
        prepare = partial(serving, settings, console)
        asks = served_asks(settings)
        return fetch_batch(asks, run, console, quota=settings.quota, prepare=prepare)

    def work(stage: str, own: Settings) -> Callable[[Batches], BatchResult]:
        return lambda earlier: _work(stage, own, run, console, engine, earlier)

    return {
        "fetch": fetched,
        "stitch": work("stitch", settings.stitch),
        "inpaint": work("inpaint", settings.inpaint),
        "expand": work("expand", settings.expand),
        "qa": lambda earlier: judge_run(settings, run, console, list(earlier.values())),
        "probes": lambda earlier: keep_run(settings, run, console, list(earlier.values())),
        **{stage: partial(_model_stage, stage, settings, run, console) for stage in MODEL_STAGES},
    }


def _work(
    stage: str,
    settings: Settings,
    run: RunFolder,
    console: Console,
    engine: Engine,
    earlier: Batches,
) -> BatchResult:
    # Only what came through the stage before: a file left by other settings is not this run's.
    passed = {receipt.item for receipt in list(earlier.values())[-1].receipts}
    tasks = [task for task in run_tasks(stage, run, settings) if task.item in passed]
    return run_batch(stage, tasks, console, engine=engine, run=run)


def _model_stage(
    stage: str, settings: PipelineSettings, run: RunFolder, console: Console, earlier: Batches
) -> BatchResult:
    # Here, because a run that ends with probes needs none of it.
    if stage == "references":
        from panokit.pipeline.references import gather_references

        return gather_references(settings, run, console)
    if stage == "evaluate":
        from panokit.pipeline.judging_models import evaluate_arms

        datasets, models = earlier["dataset"].receipts, earlier["train"].receipts
        return evaluate_arms(settings, run, console, datasets, models)
    from panokit.pipeline.modelling import render_arms, train_arms

    if stage == "train":
        return train_arms(settings, run, console, earlier["dataset"].receipts)
    maps = {receipt.item: receipt for receipt in earlier["expand"].receipts}
    passed = [maps[receipt.item] for receipt in earlier["qa"].receipts]
    return render_arms(settings, run, console, earlier["references"].receipts[0], passed)


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

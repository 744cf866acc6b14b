"""`panokit run`: a pipeline from its TOML file."""

import json as json_text
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from panokit.cli.options import Flag, Json
from panokit.console import Console, duration_text, size_text
from panokit.errors import RejectionsError, UsageError

if TYPE_CHECKING:
    from panokit.pipeline import PipelineSettings, RunResult
    from panokit.pipeline.orphans import Orphan


def run(  # noqa: PLR0913 (each is an option of the command)
    pipeline: Path,
    /,
    *,
    out: Path | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set")] = (),
    engine: str | None = None,
    workers: int | None = None,
    stop_after: str | None = None,
    retry_rejected: Flag = False,
    plan: Flag = False,
    status: Flag = False,
    orphans: Flag = False,
    clean: Flag = False,
    json: Json = False,
) -> int:
    """Run a pipeline: a city list in, light probes and a report out, or models.

    Run it again to go on where it stopped; what is complete is skipped.

    Parameters
    ----------
    pipeline
        The TOML file, for instance pipelines/three-cities.toml.
    out
        The run's folder, instead of the one in the file.
    set_
        Replace a setting of the file: --set fetch.count=3. Can be given several times.
    engine
        serial, local, dask, slurm or the address of a Dask scheduler.
    workers
        Of the engine. If not given: one for each core, one job on Slurm, all that a scheduler has.
    stop_after
        The last stage, for instance expand; all that the pipeline has if not given.
    retry_rejected
        Try items again that an earlier run rejected.
    plan
        Only say what it would take: items, requests, money, disk and time.
    status
        Only say how far the run is; it may be going on in another process.
    orphans
        Only list what in the run's folder belongs to nothing any more.
    clean
        Delete what --orphans lists.
    """
    from panokit.pipeline import PipelineSettings, load_settings, run_pipeline

    console = Console(as_json=json)
    overrides = list(set_)
    for name, value in (("output", out), ("engine", engine)):
        # JSON's strings are TOML's, too.
        overrides += [] if value is None else [f"{name}={json_text.dumps(str(value))}"]
    overrides += [] if workers is None else [f"workers={workers}"]
    settings = load_settings(pipeline, PipelineSettings, overrides)
    looks = {"--plan": plan, "--status": status, "--orphans": orphans, "--clean": clean}
    if sum(looks.values()) > 1:
        given = " and ".join(name for name, is_given in looks.items() if is_given)
        raise UsageError(f"{given} are different things; give one of them.")
    if plan:
        return _plan(settings, stop_after, console)
    if status:
        return _status(settings, console)
    if orphans or clean:
        return _orphans(settings, console, clean=clean)
    result = run_pipeline(settings, console, stop_after=stop_after, retry_rejected=retry_rejected)
    return report_run(result, settings.max_rejected_share, console)


def report_run(result: "RunResult", max_rejected_share: float, console: Console) -> int:
    """Print what became of a run; exit code 1 if too much was rejected."""
    if result.nothing_to_do:
        console.result(f"Nothing to do: everything in {result.run.root} is complete.")
    for batch in result.batches:
        console.result(batch.summary())
    if result.report:
        console.result(f"Report: {result.report}")
    if result.overview:
        console.result(f"The run: {result.overview}")
    console.value(
        {
            "run": str(result.run.root),
            "report": result.report and str(result.report),
            "overview": result.overview and str(result.overview),
            "nothing_to_do": result.nothing_to_do,
            "stages": {
                batch.stage: {
                    "fresh": batch.fresh,
                    "complete": batch.found,
                    "rejected": [rejection.to_json() for rejection in batch.rejections],
                }
                for batch in result.batches
            },
        }
    )
    if result.rejected_share > max_rejected_share:
        raise RejectionsError(
            f"{result.rejected_share:.0%} of the items were rejected, more than the "
            f"{max_rejected_share:.0%} that max_rejected_share allows. See {result.run.root}/"
            "manifest.jsonl for the reasons."
        )
    return 0


def _plan(settings: "PipelineSettings", stop_after: str | None, console: Console) -> int:
    from panokit.pipeline.planning import plan_pipeline

    plan = plan_pipeline(settings, stop_after=stop_after)
    rows = [
        (
            stage.stage,
            "?" if stage.items is None else f"{stage.items:,}",
            f"{stage.done:,}",
            f"{stage.requests:,}" if stage.requests else "",
            f"{stage.cost_usd:,.2f}" if stage.requests else "",
            duration_text(stage.cpu_s),
            duration_text(stage.seconds),
            size_text(stage.bytes),
        )
        for stage in plan.stages
    ]
    sums = {name: plan.total(name) for name in ("requests", "cost_usd", "cpu_s", "seconds")}
    rows.append(
        (
            "all", "", "", f"{sums['requests']:,.0f}", f"{sums['cost_usd']:,.2f}",
            duration_text(sums["cpu_s"]), duration_text(sums["seconds"]),
            size_text(plan.total("bytes")),
        )
    )  # fmt: skip
    header = ("stage", "items", "done", "requests", "USD", "processor", "time", "disk")
    console.table(header, tuple(rows))
    fits = "" if plan.total("bytes") < plan.free_bytes else ": IT DOES NOT FIT"
    workers = f"{plan.workers} worker{'' if plan.workers == 1 else 's'}"
    console.result(f"Time is for {workers}; {size_text(plan.free_bytes)} are free{fits}.")
    if plan.quota_days:
        console.result(f"The usual daily quota of the source makes it {plan.quota_days} days.")
    if not plan.within_quota:
        console.result("One start stops at the pipeline's quota; each later one goes on.")
    console.result(f"Estimates, from costs measured {plan.measured}. Nothing was started.")
    console.value(plan.to_json())
    return 0


def _status(settings: "PipelineSettings", console: Console) -> int:
    from panokit.pipeline.status import run_status

    found = run_status(settings)
    rows = [
        (
            stage.stage,
            f"{stage.done:,}",
            "?" if stage.waiting is None else f"{stage.waiting:,}",
            ", ".join(f"{count} {reason}" for reason, count in stage.rejected.items()) or "0",
            f"{stage.per_hour:,.0f}" if stage.per_hour else "",
            duration_text(stage.left_s) if stage.left_s else "",
        )
        for stage in found.stages
    ]
    console.table(("stage", "done", "waiting", "rejected", "per hour", "left"), tuple(rows))
    console.result(f"Driven by {found.driver}." if found.driver else "No process drives it now.")
    console.value(found.to_json())
    return 0


def _orphans(settings: "PipelineSettings", console: Console, *, clean: bool) -> int:
    from panokit.pipeline.orphans import find_orphans, remove_orphans

    found: list[Orphan] = remove_orphans(settings) if clean else find_orphans(settings)
    for orphan in found:
        console.result(f"{orphan.path}  ({orphan.why}, {size_text(orphan.bytes)})")
    whole = size_text(sum(orphan.bytes for orphan in found))
    if clean:
        console.result(f"{len(found)} deleted, {whole}")
    else:
        console.result(f"{len(found)} orphans, {whole}{'; --clean deletes them' if found else ''}")
    console.value([{"path": str(o.path), "why": o.why, "bytes": o.bytes} for o in found])
    return 0

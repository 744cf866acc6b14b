"""`panokit run`: a pipeline from its TOML file."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.console import Console
from panokit.errors import RejectionsError

if TYPE_CHECKING:
    from panokit.pipeline import RunResult


def run(
    pipeline: Path,
    /,
    *,
    out: Path | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set")] = (),
    stop_after: str | None = None,
    retry_rejected: Annotated[bool, Parameter(negative=())] = False,
    json: Json = False,
) -> int:
    """Run a pipeline: a city list in, light probes and a report out.

    Run it again to go on where it stopped; what is complete is skipped.

    Parameters
    ----------
    pipeline
        The TOML file, for instance pipelines/three-cities.toml.
    out
        The run's folder, instead of the one in the file.
    set_
        Replace a setting of the file: --set fetch.count=3. Can be given several times.
    stop_after
        The last stage: fetch, stitch, inpaint, expand, qa or probes.
    retry_rejected
        Try items again that an earlier run rejected.
    """
    from panokit.pipeline import PipelineSettings, load_settings, run_pipeline

    console = Console(as_json=json)
    overrides = set_ if out is None else (*set_, f"output={str(out)!r}")
    settings = load_settings(pipeline, PipelineSettings, overrides)
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
    console.value(
        {
            "run": str(result.run.root),
            "report": result.report and str(result.report),
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

"""`panokit fetch`: street panoramas into a run folder."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.console import Console, size_text
from panokit.fetch.settings import FetchSettings


def fetch(
    *,
    out: Path,
    settings: Annotated[FetchSettings, Parameter(name="*")] = FetchSettings(),
    json: Json = False,
) -> int:
    """Fetch street panoramas of cities.

    Run it again to go on where it stopped; what is there is not fetched again.

    Parameters
    ----------
    out
        The run folder.
    """
    from panokit.pipeline.fetching import fetch_into
    from panokit.records import RunFolder

    console = Console(as_json=json)
    run = RunFolder(out)
    if not settings.dry_run:
        run.create().remove_leftovers()
    result = fetch_into(settings, run, console)
    if result.plan is not None:
        plan = result.plan
        console.result(
            f"Would fetch {plan.panoramas} panoramas: {plan.files} files, about "
            f"{size_text(plan.bytes)}, ${plan.cost_usd:.2f}"
        )
        if plan.days_at_quota is not None:
            console.result(f"At the source's usual quota that takes {plan.days_at_quota:.1f} days")
    else:
        console.result(
            f"fetch: {len(result.stored)} stored, {len(result.existing)} there already, "
            f"{len(result.rejections)} rejected, {result.requests} requests"
        )
    for reason, count in sorted(result.passed_over.items()):
        console.note(f"fetch: {count} passed over: {reason}")
    console.value(
        {
            "stored": [stored.capture.key for stored in result.stored],
            "existing": [stored.capture.key for stored in result.existing],
            "rejected": [rejection.to_json() for rejection in result.rejections],
            "passed_over": dict(result.passed_over),
            "requests": result.requests,
            "plan": result.plan
            and {name: getattr(result.plan, name) for name in result.plan.__slots__},
        }
    )
    return 1 if result.rejections else 0

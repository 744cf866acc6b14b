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
    # A place without pictures is a rejection too, but no panorama that was rejected.
    rejected = sum(one.reason != "no-imagery" for one in result.rejections)
    nowhere = " or ".join(place for place, (found, _) in result.short.items() if not found)
    if result.plan is not None:
        plan = result.plan
        console.result(
            f"Would fetch {_many(plan.panoramas, 'panorama')}: {_many(plan.files, 'file')}, about "
            f"{size_text(plan.bytes)}, ${plan.cost_usd:.2f}"
        )
        if plan.days_at_quota is not None and plan.days_at_quota > 1:
            console.result(f"At the source's usual quota that takes {plan.days_at_quota:.1f} days")
    else:
        console.result(
            f"fetch: {len(result.stored)} stored, {len(result.existing)} there already, "
            f"{rejected} rejected, {_many(result.requests, 'request')}"
            f"{f'; none found in {nowhere}' if nowhere else ''}"
        )
    for reason, count in sorted(result.passed_over.items()):
        console.note(f"fetch: {count} passed over: {reason}")
    console.value(
        {
            "stored": [stored.capture.key for stored in result.stored],
            "existing": [stored.capture.key for stored in result.existing],
            "rejected": [rejection.to_json() for rejection in result.rejections],
            "short": {
                place: {"found": found, "wanted": wanted}
                for place, (found, wanted) in result.short.items()
            },
            "passed_over": dict(result.passed_over),
            "requests": result.requests,
            "plan": result.plan
            and {name: getattr(result.plan, name) for name in result.plan.__slots__},
        }
    )
    return 1 if result.rejections or result.short else 0


def _many(count: int, thing: str) -> str:
    return f"{count} {thing}{'' if count == 1 else 's'}"

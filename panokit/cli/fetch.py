"""`panokit fetch`: street panoramas into a run folder."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.console import Console, size_text
from panokit.fetch.settings import FetchSettings

if TYPE_CHECKING:
    from panokit.fetch import FetchPlan


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
        run.create()
    result = fetch_into(settings, run, console)
    # A place without pictures is a rejection too, but no panorama that was rejected.
    rejected = sum(one.reason != "no-imagery" for one in result.rejections)
    nowhere = " or ".join(place for place, (found, _) in result.short.items() if not found)
    if result.plan is not None:
        console.result(f"Fetching from {settings.source} would take:")
        for label, text in plan_rows(result.plan, result.requests):
            console.result(f"  {label:15} {text}")
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


def plan_rows(plan: "FetchPlan", searched: int) -> list[tuple[str, str]]:
    """A plan for people: what, and how much of it.

    Args:
        plan: What fetching would take.
        searched: Requests that finding it out took.
    """
    one_each = plan.files == plan.panoramas
    rows = [("panoramas", f"{plan.panoramas:,}")]
    rows += [] if one_each else [(f"{plan.unit}s", f"{plan.files:,}")]
    rows += [("requests", f"{plan.files:,}, and {searched:,} already made to search")]
    if plan.quota_share is not None:
        days = _many(plan.days_at_quota or 0, "day")
        rows += [
            ("daily quota", f"{plan.quota_share:.1%} of the usual one"),
            ("time at quota", days),
        ]
    rows += [("download", f"about {size_text(plan.bytes)}")]
    if plan.cost_usd == 0:
        return [*rows, ("cost", "nothing")]
    cost = f"{plan.cost_usd:,.2f} USD by list price"
    if plan.free_files:
        rows += [("cost", f"{cost}; {plan.least_cost_usd:,.2f} USD if this month's")]
        return [*rows, ("", f"{plan.free_files:,} free {plan.unit}s are still there")]
    return [*rows, ("cost", cost)]


def _many(count: int, thing: str) -> str:
    return f"{count:,} {thing}{'' if count == 1 else 's'}"

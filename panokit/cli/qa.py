"""`panokit qa`: judge maps, compare them with references, write a report."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.console import Console
from panokit.qa.settings import QaSettings


def qa(
    inputs: list[Path],
    /,
    *,
    out: Path | None = None,
    reference: Path | None = None,
    title: str = "Light probes",
    settings: Annotated[QaSettings, Parameter(name="*")] = QaSettings(),
    json: Json = False,
) -> int:
    """Check maps, compare them with references, write a report.

    Parameters
    ----------
    inputs
        A run folder, or HDR maps, or folders of them.
    out
        Where report.html and qa.json go; a run keeps them in RUN/qa.
    reference
        A folder of HDR maps. One with the name of a map is its truth; the others make the
        distribution that every map is placed in.
    title
        The heading of the report.
    """
    from panokit.errors import UsageError
    from panokit.qa import find_items, write_report
    from panokit.qa import qa as judge
    from panokit.records import RunFolder

    console = Console(as_json=json)
    run = RunFolder(inputs[0]) if len(inputs) == 1 else None
    target = out or (run.qa if run and run.is_run else None)
    if target is None:
        raise UsageError("Say where the report goes with --out DIR.")
    items = find_items(inputs)
    with console.stage("qa", len(items)) as tick:
        result = judge(
            items,
            settings,
            reference=reference,
            on_judged=lambda judged: tick(rejected=judged.rejection is not None),
        )
    report = write_report(result, target, title=title)
    for judged in result.unreadable:
        if judged.rejection:
            console.note(f"qa: {judged.item.name} rejected: {judged.rejection.message}")
    console.result(
        f"qa: {len(result.passed)} without a defect, {len(result.failed)} with one, "
        f"{len(result.unreadable)} unreadable"
    )
    console.result(f"Report: {report}")
    console.value(result.to_json())
    return 1 if result.unreadable else 0

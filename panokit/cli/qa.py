"""`panokit qa`: judge maps, compare them with references, write a report."""

from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from panokit.cli.options import Flag, Json
from panokit.console import Console
from panokit.qa.settings import QaSettings

if TYPE_CHECKING:
    from panokit.qa.batch import QaResult

_MOST_LISTED = 20
_COLUMNS = 78


def qa(
    inputs: list[Path],
    /,
    *,
    out: Path | None = None,
    reference: Path | None = None,
    truth: Path | None = None,
    title: str = "Light probes",
    pictures: Flag = False,
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
        A folder of HDR maps that the maps are held against as a set. One with the name of a map
        is its truth; the others make the distribution that every map is placed in.
    truth
        A folder of true maps, by the names or ids of the maps: every pair is scored under every
        protocol and pictured. Then the reference gives no truths.
    title
        The heading of the report.
    pictures
        Also draw where each map lies among captured maps: OUT/plausibility/NAME.png.
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
    result = judge(
        items,
        settings,
        reference=reference,
        truth=truth,
        out=target,
        pictures=pictures,
        stage=console.stage,
    )
    report = write_report(result, target, title=title)
    for judged in result.unreadable:
        if judged.rejection:
            console.note(f"qa: {judged.item.name} rejected: {judged.rejection.message}")
    console.result(
        f"qa: {len(result.passed)} without a defect, {len(result.failed)} with one, "
        f"{len(result.unreadable)} unreadable"
    )
    for line in (*_defects(result), *_against(result)):
        console.result(line)
    console.result(f"Report: {report}")
    console.value(result.to_json())
    return 1 if result.unreadable else 0


def _defects(result: "QaResult") -> list[str]:
    """Each check that fails, with its figure and its limits, under the name of the map."""
    lines = []
    for judged in result.failed[:_MOST_LISTED]:
        lines.append(f"  {judged.item.name}")
        for check in judged.report.failed if judged.report else ():
            bounds = (("at least", check.low), ("at most", check.high))
            limits = " and ".join(
                f"{word} {limit:g}" for word, limit in bounds if limit is not None
            )
            said = f"{check.name}: {check.value:.3g} {check.unit}".rstrip() + f", allowed {limits}"
            text = f"{said}; {check.note}" if check.note else said
            lines += wrap(text, _COLUMNS, initial_indent="    ", subsequent_indent="      ")
    if len(result.failed) > _MOST_LISTED:
        lines.append(f"  and {len(result.failed) - _MOST_LISTED} more: see the report")
    return lines


def _against(result: "QaResult") -> list[str]:
    """What is to be said of truths and of the reference set."""
    lines = []
    if result.pairs is not None:
        compared = [score for score in result.pairs.scores if not score.obstacle]
        lines.append(
            f"Pairs: {len(compared)} compared, {len(result.pairs.without_truth)} maps without "
            f"truth, {len(result.pairs.unused)} truths without a map"
        )
    if result.sets is not None:
        found = result.sets
        effects = ", ".join(f"{count} {effect}" for effect, count in found.effects.items())
        lines.append(
            f"Set of {len(found.augmented)} against {len(found.reference)}, figure by figure: "
            f"{effects}; {len(found.duplicates)} near-duplicates"
        )
    return lines

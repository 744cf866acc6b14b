"""The report of QA: report.html for people, qa.json for programs."""

from collections.abc import Sequence
from pathlib import Path

from panokit.errors import ItemError, Rejection
from panokit.io import write_json
from panokit.qa.batch import JudgedMap, QaResult
from panokit.qa.pairs.showing import pair_sections
from panokit.qa.report import words
from panokit.qa.report.accuracy import explanation, medians
from panokit.qa.report.cards import count_layers, entry_of
from panokit.qa.report.distributions import check_charts, difference_charts
from panokit.qa.sets.showing import set_sections
from panokit.report.layers import layer_width_px
from panokit.report.page import write_page
from panokit.report.plain import sections_of
from panokit.report.values import (
    Badge,
    Cell,
    Column,
    Count,
    Counts,
    Gallery,
    MapEntry,
    Page,
    Section,
    Table,
    Text,
)
from panokit.report.wording import format_figure, words_of

REPORT_NAME = "report.html"
JSON_NAME = "qa.json"
_CHECK_COLUMNS = ("dynamic-range", "top-share")
_DIFFERENCE_COLUMNS = ("irradiance-error", "light-direction")
# What the page shows by itself; anything else that QA tells is shown as it is.
_SHOWN = {
    "schema",
    "version",
    "settings",
    "counts",
    "references",
    "skipped_references",
    "maps",
    "rejections",
    "sets",
    "pairs",
}


def write_report(
    result: QaResult,
    out: Path,
    *,
    title: str = "Light probes",
    rejections: Sequence[Rejection] = (),
) -> Path:
    """Write OUT/report.html and OUT/qa.json.

    Args:
        result: What `qa` found out.
        out: The folder.
        title: The page's heading.
        rejections: Items that earlier stages of the run could not use.

    Returns:
        The path of report.html, which opens from disk and asks nothing of any server.

    Raises:
        StorageError: If the folder cannot be written.
    """
    page = report_page(result, title=title, rejections=rejections, out=out)
    path = write_page(page, out / REPORT_NAME)
    record = {**result.to_json(), "rejections": [r.to_json() for r in rejections]}
    write_json(out / JSON_NAME, record)
    return path


def report_page(
    result: QaResult,
    *,
    title: str = "Light probes",
    rejections: Sequence[Rejection] = (),
    out: Path | None = None,
) -> Page:
    """The report as values; arguments as of `write_report`.

    Without `out` it has no pictures of pairs.
    """
    entries, gone = _entries(result)
    rejected = (
        *rejections,
        *(judged.rejection for judged in result.unreadable if judged.rejection),
        *gone,
    )
    shown = {entry.name for entry in entries}
    maps = [judged for judged in result.maps if judged.item.name in shown]
    sections: list[Section | None] = [
        _rejection_table(rejected),
        Gallery(title="Maps", entries=tuple(entries)) if entries else None,
        difference_charts(maps),
        check_charts(maps),
        _overview(maps) if maps else None,
        *(set_sections(result.sets) if result.sets else ()),
        *(pair_sections(result.pairs, out) if result.pairs else ()),
    ]
    for key, value in result.to_json().items():
        if key not in _SHOWN and value not in (None, [], {}, ""):
            sections += sections_of(words_of(key), value)
    return Page(
        title=title,
        head=_head(result, len(entries), len(rejected)),
        sections=tuple(section for section in sections if section is not None),
        footer=_method(result),
    )


def synthetic_banner(maps: Sequence[JudgedMap]) -> str:
    """What to say of captures that are no photographs; "" if all are."""
    synthetic = sum(
        judged.capture is not None and judged.capture.details.get("synthetic") is True
        for judged in maps
    )
    said = "rendered by panokit's synthetic city, not photographs"
    if not synthetic:
        return ""
    if synthetic == len(maps):
        return f"These panoramas are {said}."
    verb = "is" if synthetic == 1 else "are"
    return f"{synthetic} of these {len(maps)} panoramas {verb} {said}."


def _entries(result: QaResult) -> tuple[list[MapEntry], list[Rejection]]:
    width = layer_width_px(*count_layers(result.maps))
    entries: list[MapEntry] = []
    gone = []
    for judged in result.maps:
        if judged.report is None:
            continue
        try:
            entries.append(entry_of(judged, width))
        except ItemError as error:
            gone.append(Rejection.from_error(judged.item.name, "qa", error))
    return entries, gone


def _head(result: QaResult, shown: int, rejected: int) -> tuple[Section, ...]:
    failed = len(result.failed)
    counts = [
        Count(label="light map" if shown == 1 else "light maps", value=str(shown)),
        Count(label="no defect found", value=str(len(result.passed))),
        Count(label="with a defect", value=str(failed), tone="fail" if failed else ""),
        Count(label="rejected", value=str(rejected), tone="fail" if rejected else ""),
    ]
    for middle in medians(result.maps):
        badge = Badge(text=middle.grade, tone=middle.grade)  # type: ignore[arg-type]
        counts.append(Count(label=middle.label, value=middle.value, badge=badge))
    head: list[Section] = [Counts(counts=tuple(counts))]
    if shown:
        head.append(Text(paragraphs=(explanation(result.maps),), small=True))
    banner = synthetic_banner(result.maps)
    if banner:
        head.append(Text(paragraphs=(banner,), tone="note"))
    return tuple(head)


def _rejection_table(rejections: Sequence[Rejection]) -> Table | None:
    """The rejections by reason, the most frequent first."""
    groups: dict[str, list[Rejection]] = {}
    for rejection in rejections:
        groups.setdefault(rejection.reason, []).append(rejection)
    if not groups:
        return None
    ordered = sorted(groups.items(), key=lambda group: (-len(group[1]), group[0]))
    return Table(
        title="Rejected",
        columns=(
            Column(label="Reason"),
            Column(label="Count", numeric=True),
            Column(label="What happened"),
        ),
        rows=tuple(
            (
                Cell(text=reason, note=f"in {', '.join(sorted({r.stage for r in items}))}"),
                Cell(text=str(len(items)), sort=float(len(items))),
                Cell(lines=tuple(f"{item.item}: {item.message}" for item in items)),
            )
            for reason, items in ordered
        ),
    )


def _overview(maps: Sequence[JudgedMap]) -> Table:
    compared = any(judged.comparison and judged.comparison.differences for judged in maps)
    columns = _CHECK_COLUMNS + (_DIFFERENCE_COLUMNS if compared else ())
    return Table(
        title="All maps",
        columns=(
            Column(label="Map"),
            Column(label="Checks"),
            *(Column(label=words_of(name), numeric=True) for name in columns),
            Column(label="License"),
        ),
        rows=tuple(
            (
                Cell(text=judged.item.name, link=judged.item.name),
                Cell(badge=words.verdict_badge(str(judged.verdict))),
                *(_cell(judged, name) for name in columns),
                Cell(text=judged.capture.license.id if judged.capture else "unknown"),
            )
            for judged in maps
        ),
        sortable=len(maps) > 1,
        note="Irradiance error and light direction are against the reference of the same name."
        if compared
        else "",
    )


def _cell(judged: JudgedMap, name: str) -> Cell:
    checks = judged.report.checks if judged.report else ()
    differences = judged.comparison.differences if judged.comparison else ()
    figures = {check.name: (check.value, check.unit) for check in checks}
    figures |= {difference.name: (difference.value, difference.unit) for difference in differences}
    value, unit = figures.get(name, (None, ""))
    badge = words.grade_badge(name, value)
    return Cell(text=format_figure(value, unit), badge=badge, sort=value)


def _method(result: QaResult) -> tuple[str, ...]:
    said = [
        "Exposure starts at the camera's own where a map is anchored to it, else where its median "
        "is middle gray. Balls stand where the camera stood and are seen from the south, looking "
        "north; the white ball has an exposure of its own, just below white on its lit side. "
        "False color is luminance in stops from the median of the map.",
        "Maps in this page are smaller than their files, with the same energy; each value is "
        "right to 1 in 256.",
    ]
    if result.reference_names:
        said.append(f"The reference set has {len(result.reference_names)} maps.")
    if result.skipped_references:
        names = ", ".join(skipped.item for skipped in result.skipped_references)
        said.append(f"Reference files that could not be read: {names}.")
    return tuple(said)

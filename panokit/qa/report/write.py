"""The report of QA: report.html for people, qa.json for programs."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import panokit
from panokit.errors import ItemError, Rejection
from panokit.io import write_bytes, write_json
from panokit.qa.batch import JudgedMap, QaResult
from panokit.qa.report import pictures
from panokit.qa.report.accuracy import explanation, grade_of, medians
from panokit.qa.report.cards import Card, card_of
from panokit.qa.report.html import format_figure, picture, render_page
from panokit.qa.report.words import label_of

REPORT_NAME = "report.html"
JSON_NAME = "qa.json"
_CHECK_COLUMNS = ("dynamic-range", "top-share")
_DIFFERENCE_COLUMNS = ("irradiance-error", "light-direction")


@dataclass(frozen=True, slots=True, kw_only=True)
class ReasonGroup:
    """The rejections that share a reason."""

    reason: str
    stages: tuple[str, ...]
    items: tuple[Rejection, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One figure in the table of all maps, with its grade where it is graded."""

    text: str
    grade: str


@dataclass(frozen=True, slots=True, kw_only=True)
class OverviewRow:
    """One map in the table of all maps."""

    name: str
    anchor: str
    verdict: str
    cells: tuple[Cell, ...]
    license: str


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
    cards, gone = _cards(result)
    rejected = (
        *rejections,
        *(judged.rejection for judged in result.unreadable if judged.rejection),
        *gone,
    )
    page = render_page(
        "qa.html.j2",
        title=title,
        version=panokit.__version__,
        counts={
            "maps": len(cards),
            "passed": len(result.passed),
            "failed": len(result.failed),
            "rejected": len(rejected),
        },
        medians=medians(result.maps),
        explanation=explanation(result.maps) if cards else "",
        banner=synthetic_banner(result.maps),
        rejections=_by_reason(rejected),
        overview=_overview(result, cards),
        cards=cards,
        legend=picture(pictures.false_color_legend(), alt="", quality=90),
        legend_ticks=_legend_ticks(),
        method=_method(result),
    )
    path = out / REPORT_NAME
    write_bytes(path, page.encode())
    record = {**result.to_json(), "rejections": [r.to_json() for r in rejections]}
    write_json(out / JSON_NAME, record)
    return path


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


def _cards(result: QaResult) -> tuple[list[Card], list[Rejection]]:
    cards, gone = [], []
    taken: set[str] = set()
    for judged in result.maps:
        if judged.report is None:
            continue
        try:
            cards.append(card_of(judged, _anchor(judged.item.name, taken)))
        except ItemError as error:
            gone.append(Rejection.from_error(judged.item.name, "qa", error))
    return cards, gone


def _anchor(name: str, taken: set[str]) -> str:
    base = "map-" + re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")
    anchor, number = base, 2
    while anchor in taken:
        anchor, number = f"{base}-{number}", number + 1
    taken.add(anchor)
    return anchor


def _by_reason(rejections: Sequence[Rejection]) -> list[ReasonGroup]:
    groups: dict[str, list[Rejection]] = {}
    for rejection in rejections:
        groups.setdefault(rejection.reason, []).append(rejection)
    return [
        ReasonGroup(
            reason=reason,
            stages=tuple(sorted({item.stage for item in items})),
            items=tuple(items),
        )
        for reason, items in sorted(groups.items(), key=lambda group: (-len(group[1]), group[0]))
    ]


def _overview(result: QaResult, cards: Sequence[Card]) -> dict[str, Any]:
    shown = {card.name: card for card in cards}
    maps = [judged for judged in result.maps if judged.report and judged.item.name in shown]
    compared = any(judged.comparison and judged.comparison.differences for judged in maps)
    columns = _CHECK_COLUMNS + (_DIFFERENCE_COLUMNS if compared else ())
    return {
        "columns": [label_of(name) for name in columns],
        "rows": [
            OverviewRow(
                name=judged.item.name,
                anchor=shown[judged.item.name].anchor,
                verdict=str(judged.verdict),
                cells=tuple(_cell(judged, name) for name in columns),
                license=shown[judged.item.name].license,
            )
            for judged in maps
        ],
        "note": "Irradiance error and light direction are against the reference of the same name."
        if compared
        else "",
    }


def _cell(judged: JudgedMap, name: str) -> Cell:
    checks = judged.report.checks if judged.report else ()
    differences = judged.comparison.differences if judged.comparison else ()
    figures = {check.name: (check.value, check.unit) for check in checks}
    figures |= {difference.name: (difference.value, difference.unit) for difference in differences}
    value, unit = figures.get(name, (None, ""))
    return Cell(text=format_figure(value, unit), grade=grade_of(name, value))


def _legend_ticks() -> list[str]:
    stops = range(pictures.LOWEST_STOP, pictures.HIGHEST_STOP + 1, 4)
    return [f"{'+' if s > 0 else '−' if s < 0 else ''}{abs(s)}" for s in stops]


def _method(result: QaResult) -> str:
    words = [
        "Brackets start at the camera's own exposure where the map is anchored to it, else "
        "where the median is middle gray. Balls are seen from the south, looking north."
    ]
    if result.reference_names:
        words.append(f"The reference set has {len(result.reference_names)} maps.")
    if result.skipped_references:
        names = ", ".join(skipped.item for skipped in result.skipped_references)
        words.append(f"Reference files that could not be read: {names}.")
    return " ".join(words)

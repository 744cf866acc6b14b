"""The evaluation as one HTML page, as Markdown, and as files of its figures and tables.

OUT/report.html, report.md, summary.json, figures/*.png and *.pdf, tables/*.csv
"""

import base64
import struct
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from panokit.evaluate.lighting.figures.drawing import FigureFile
from panokit.evaluate.lighting.model_tables import all_marks
from panokit.evaluate.lighting.pack import Pack, make_pack, summary_of
from panokit.evaluate.lighting.statements import FAILS, HOLDS, PRIMARY
from panokit.evaluate.lighting.tables import TextTable
from panokit.evaluate.lighting.verdicts import Verdict
from panokit.io.files import write_bytes, write_json
from panokit.report.page import write_page
from panokit.report.pictures import Picture
from panokit.report.values import (
    Badge,
    Cell,
    Column,
    Count,
    Counts,
    Group,
    Page,
    Pictures,
    Section,
    Table,
    Text,
    Tone,
)

_TONES: Mapping[str, Tone] = {
    str(Verdict.REPRODUCED): "good", HOLDS: "good", str(Verdict.NOT_REPRODUCED): "poor",
    FAILS: "poor", str(Verdict.UNDECIDED): "note",
}  # fmt: skip
# Heading, figures, tables below them, and tables that are folded.
_PARTS: tuple[tuple[str, tuple[str, ...], tuple[str, ...], tuple[str, ...]], ...] = (
    ("Verdicts", (), ("V",), ("V-2",)),
    ("Scores", ("F5.7", "F5.7 log", "F5.7 SSD"), ("T-1", "T-2"), ("T-3", "T-4", "F5.7")),
    ("Training", ("F5.1", "F5.2", "F5.3", "F5.4", "F5.5", "F5.6"), ("F5-ratios",), ("F5-curves",)),
    ("MSE and DSSIM", ("F5.8", "F5.9", "F5.8 sheet", "F5.9 sheet"), (), ("F5.8", "F5.9")),
    ("Where the light is", ("F5.10a", "F5.10b", "F5.10c", "F5.10 sheet"), ("F5.10-strata",),
     ("F5.10", "F5.10-rgb", "F5.10-luma", "F5.10-wrapped")),
    ("Scenes in predicted light", ("F-C", "F-I"), (), ()),
    ("Normals, memory, the second view", ("F-Da", "F-Db", "F-F", "F-E"), ("F-E",), ("F-F",)),
    ("Reflectance maps", (), ("T-R",), ()),
    ("Size and speed", (), ("T-B",), ()),
    ("Ablation", (), ("T-A",), ("T-A2",)),
    ("Protocols of others", (), (),
     ("T-G-spheres-compat", "T-G-spheres-fixed", "T-G-array-compat", "T-G-array-fixed")),
    ("Data", ("F-J", "T-K elevation", "T-K directedness"), ("T-K", "T-K-test"), ()),
)  # fmt: skip
_FOOTER = (
    "Scores of a sample are means over seeds; intervals are percentile bootstraps that draw places "
    "anew, since samples of one place are alike. Figures are written beside this page as PNG and "
    "PDF, tables as CSV; `panokit evaluate figures` draws them anew without models or dataset.",
)


def write_pack(folder: Path, tick: Callable[[], object] = lambda: None) -> dict[str, Any]:
    """Draw everything and write it beside the results; what it was before is replaced.

    Returns:
        What summary.json holds.

    Raises:
        StorageError: If the folder holds no results, or cannot be written.
    """
    pack = make_pack(folder, tick)
    for figure in pack.figures.values():
        write_bytes(folder / "figures" / f"{figure.stem}.png", figure.png)
        if figure.pdf:
            write_bytes(folder / "figures" / f"{figure.stem}.pdf", figure.pdf)
    for table in pack.tables.values():
        write_bytes(folder / "tables" / table.file, table.csv().encode())
    summary = summary_of(pack)
    write_json(folder / "summary.json", summary)
    write_bytes(folder / "report.md", report_markdown(pack).encode())
    tick()
    write_page(report_page(pack), folder / "report.html")
    tick()
    return summary


def report_page(pack: Pack) -> Page:
    """The page."""
    sections: list[Section] = []
    for title, figures, tables, folded in _PARTS:
        named = [pack.figures[name] for name in _with_sizes(pack, figures)]
        inside = [*_pictures(named), *(_table(pack, name) for name in tables
                                       if name in pack.tables)]  # fmt: skip
        for name in folded:
            if name in pack.tables:
                table = _table(pack, name)
                inside.append(Group(title=table.title, folded=True,
                                    sections=(replace(table, title=""),)))  # fmt: skip
        if inside:
            sections.append(Group(title=title, sections=tuple(inside)))
    outcome = pack.outcome
    return Page(
        title=f"Light from two views: {outcome.dataset.get('name') or outcome.folder.name}",
        head=_head(pack),
        sections=tuple(sections),
        footer=_FOOTER,
    )


def _with_sizes(pack: Pack, names: Iterable[str]) -> list[str]:
    """The figures of these ids that there are, and those of further sizes."""
    sizes = [size for size in pack.outcome.sizes if size]
    wanted = [f"{name}{size and f' {size}'}" for name in names for size in ("", *sizes)]
    return [name for name in wanted if name in pack.figures]


def _head(pack: Pack) -> tuple[Section, ...]:
    outcome = pack.outcome
    models = [e for e in outcome.entrants if not e.is_baseline]
    primary = [one for one in pack.findings if one.figure == one.statement.primary]
    counts = [
        Count(label="samples", value=f"{len(outcome.keys):,}"),
        Count(label="places", value=str(len(set(outcome.place_names)))),
        Count(label="experiments", value=str(len(models))),
        Count(label="trained networks", value=str(sum(len(e.members) for e in models))),
    ]
    words = Counter(one.word for one in primary)
    counts += [Count(label=word, value=str(words[word]), tone=tone)
               for word, tone in _TONES.items() if words[word]]  # fmt: skip
    head: list[Section] = [Counts(counts=tuple(counts)), Text(paragraphs=tuple(_summary(pack)))]
    if marks := all_marks(outcome):
        head.append(Text(paragraphs=(marks,), tone="note"))
    return tuple(head)


def _summary(pack: Pack) -> list[str]:
    """What a reader is to know at once."""
    outcome = pack.outcome
    said = []
    light = outcome.entrants_with(PRIMARY)
    models = [e for e in light if not e.is_baseline]
    if models:
        means = {e.name: s.mean for e in light if (s := outcome.spread(e, PRIMARY)) is not None}
        best = min(models, key=lambda one: means[one.name])
        mean_map = outcome.entrant("mean map")
        against = (
            f", where the mean map of the training has {means[mean_map.name]:.3g}"
            if mean_map and mean_map.name in means else ""
        )  # fmt: skip
        said.append(
            f"Best by the sum of squared differences of code values, the thesis's own measure: "
            f"{best.title} with {means[best.name]:.3g}{against}."
        )
    unfinished = [e.title for e in outcome.entrants if outcome.not_converged(e)]
    if unfinished:
        said.append(f"Not converged, in some or all seeds: {', '.join(unfinished)}.")
    said.append(
        "All models and baselines are judged on the same samples of places and objects that are in "
        "no other split. Figures of the thesis are on other data; they stand beside ours for "
        "orientation only."
    )
    return said


def _pictures(figures: list[FigureFile]) -> list[Section]:
    """Narrow figures beside each other, wide ones alone."""
    found: list[Section] = []
    narrow = tuple(_picture(one) for one in figures if not one.wide)
    if narrow:
        found.append(Pictures(pictures=narrow))
    wide = tuple(_picture(one) for one in figures if one.wide)
    return [*found, *([Pictures(pictures=wide, wide=True)] if wide else [])]


def _picture(figure: FigureFile) -> Picture:
    width, height = struct.unpack(">II", figure.png[16:24])
    return Picture(
        uri=f"data:image/png;base64,{base64.b64encode(figure.png).decode()}",
        width_px=width,
        height_px=height,
        alt=f"{figure.id}: {figure.title}",
        caption=f"{figure.id}. {figure.title}. {figure.caption}",
    )


def _table(pack: Pack, name: str) -> Table:
    table = pack.tables[name]
    badges = {word: Badge(text=word, tone=tone) for word, tone in _TONES.items()}
    return Table(
        title=f"{table.id}: {table.title}",
        columns=tuple(Column(label=c, numeric=_is_numeric(table, i))
                      for i, c in enumerate(table.columns)),
        rows=tuple(tuple(_cell(cell, badges) for cell in row) for row in table.rows),
        note=table.note,
        sortable=len(table.rows) > 3,
    )  # fmt: skip


def _cell(text: str, badges: dict[str, Badge]) -> Cell:
    word, _, why = text.partition(": ")
    if word in badges:
        return Cell(badge=badges[word], note=why)
    return Cell(text=text, sort=_number(text))


def _number(text: str) -> float | None:
    """What a cell is sorted by, if it begins with a number."""
    first = text.replace("−", "-").replace(",", "").split(" ")[0].rstrip("%~*?")
    try:
        return float(first)
    except ValueError:
        return None


def _is_numeric(table: TextTable, column: int) -> bool:
    cells = [row[column] for row in table.rows if row[column] != "–"]
    return column > 0 and bool(cells) and all(_number(cell) is not None for cell in cells)


def report_markdown(pack: Pack) -> str:
    """The tables and the figures' captions."""
    outcome = pack.outcome
    text = [f"# Light from two views: {outcome.dataset.get('name') or outcome.folder.name}", ""]
    text += [part for line in _summary(pack) for part in (line, "")]
    for title, figures, tables, folded in _PARTS:
        shown = _with_sizes(pack, figures)
        there = [name for name in (*tables, *folded) if name in pack.tables]
        if not (shown or there):
            continue
        text += [f"## {title}", ""]
        for name in shown:
            figure = pack.figures[name]
            text += [f"![{figure.title}](figures/{figure.stem}.png)", "",
                     f"*{figure.id}. {figure.title}. {figure.caption}*", ""]  # fmt: skip
        text += [line for name in there for line in (pack.tables[name].markdown(), "")]
    return "\n".join(text).rstrip() + "\n"

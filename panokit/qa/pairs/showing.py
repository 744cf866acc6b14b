"""Maps beside their truths, as sections of a report."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from panokit.errors import ItemError, StorageError
from panokit.io import decode_image
from panokit.io.files import read_bytes
from panokit.metrics import Summary
from panokit.qa.pairs.judging import PairResults
from panokit.qa.pairs.pictures import difference_scale
from panokit.qa.pairs.scoring import Column as Figure
from panokit.qa.pairs.scoring import PairScore, columns, not_scored, summaries
from panokit.report.pictures import Picture, picture
from panokit.report.values import (
    Cell,
    Column,
    Count,
    Counts,
    Group,
    Pictures,
    Section,
    Table,
    Text,
)
from panokit.report.wording import format_figure

# What a reader asks first, in this order; whether only scenes with one dominant light count.
HEADLINES: Mapping[str, bool] = {
    "energy-ratio": False,
    "irradiance-sh2": False,
    "light-vector": True,
    "sun-energy": True,
    "relit-diffuse-rmse": False,
    "relit-plane-si-rmse": True,
    "rgb-angular": False,
    "pu21-crf-psnr": False,
    "panokit-three-spheres-diffuse-rmse-fixed": False,
    "panokit-three-spheres-mirror-si-rmse-fixed": False,
}
_OF_EACH = ("irradiance-sh2", "light-vector", "sun-energy", "relit-plane-si-rmse", "pu21-crf-psnr")
_WORST_BY = "irradiance-sh2"
_MOST_PICTURES = 24
_QUALITY = 80


def pair_sections(results: PairResults, out: Path | None = None) -> tuple[Section, ...]:
    """What a report tells of maps beside their truths, in one group.

    Args:
        results: The pairs.
        out: The report's folder, with the pictures that `judge_pairs` wrote; None for none.
    """
    compared = [score for score in results.scores if not score.obstacle]
    sections: list[Section | None] = [
        _head(results, compared),
        _headlines(compared) if compared else None,
        _pictures(compared, out) if out else None,
        _each(compared) if compared else None,
        _everything(compared) if compared else None,
        _obstacles(results),
    ]
    shown = tuple(section for section in sections if section is not None)
    return (Group(title="Against the truth", sections=shown),)


def _head(results: PairResults, compared: Sequence[PairScore]) -> Counts:
    dominant = sum(score.has_dominant_light for score in compared)
    counts = [
        Count(label="maps beside their truth", value=str(len(compared))),
        Count(label="with one dominant light", value=str(dominant)),
    ]
    if results.without_truth:
        counts.append(Count(label="maps without truth", value=str(len(results.without_truth))))
    if results.unused:
        counts.append(Count(label="truths without a map", value=str(len(results.unused))))
    return Counts(counts=tuple(counts))


def _headlines(compared: Sequence[PairScore]) -> Table:
    everything, dominant = summaries(compared), summaries(compared, dominant_only=True)
    figures = {figure.name: figure for figure in columns()}
    rows = []
    for name, only_dominant in HEADLINES.items():
        summary = (dominant if only_dominant else everything)[name]
        note = "scenes with one dominant light" if only_dominant else ""
        rows.append(_summary_row(figures[name], summary, note))
    return Table(
        title="Scores",
        columns=_summary_columns(),
        rows=tuple(rows),
        note="Means with 95 % bootstrap intervals over the scenes.",
    )


def _everything(compared: Sequence[PairScore]) -> Group:
    everything = summaries(compared)
    table = Table(
        columns=_summary_columns(),
        rows=tuple(
            _summary_row(figure, everything[figure.name], figure.source) for figure in columns()
        ),
        sortable=True,
    )
    missing = Table(
        title="Protocols that do not compare maps",
        columns=(Column(label="Protocol"), Column(label="Why not")),
        rows=tuple((Cell(text=name), Cell(text=why)) for name, why in not_scored().items()),
    )
    return Group(title="Every protocol", sections=(table, missing), folded=True)


def _summary_columns() -> tuple[Column, ...]:
    return (
        Column(label="Score"),
        Column(label="Better"),
        Column(label="Median", numeric=True),
        Column(label="Mean", numeric=True),
        Column(label="5 to 95 %", numeric=True),
        Column(label="Maps", numeric=True),
    )


def _summary_row(figure: Figure, summary: Summary | None, note: str) -> tuple[Cell, ...]:
    name = Cell(text=figure.name, note=note)
    if summary is None:
        return (name, Cell(text=figure.better), *(Cell(text="–") for _ in range(4)))
    low, high = format_figure(summary.mean_low), format_figure(summary.mean_high)
    return (
        name,
        Cell(text=figure.better),
        Cell(text=format_figure(summary.p50, figure.unit), sort=summary.p50),
        Cell(text=format_figure(summary.mean), note=f"{low} to {high}", sort=summary.mean),
        Cell(text=f"{format_figure(summary.p5)} to {format_figure(summary.p95)}"),
        Cell(text=str(summary.n), sort=summary.n),
    )


def _each(compared: Sequence[PairScore]) -> Group:
    units = {figure.name: figure.unit for figure in columns()}
    table = Table(
        columns=(
            Column(label="Map"),
            *(Column(label=name, numeric=True) for name in _OF_EACH),
            Column(label="Dominance of the light", numeric=True),
        ),
        rows=tuple(
            (
                Cell(text=score.name, link=score.name),
                *(
                    Cell(text=format_figure(value, units[name]), sort=value)
                    for name in _OF_EACH
                    for value in (score.values.get(name),)
                ),
                Cell(text=format_figure(score.dominance, "×"), sort=score.dominance),
            )
            for score in compared
        ),
        sortable=True,
    )
    return Group(title="Map by map", sections=(table,), folded=len(compared) > _MOST_PICTURES)


def _pictures(compared: Sequence[PairScore], out: Path) -> Pictures | None:
    """The relit scenes of the maps that are farthest from their truth, worst first."""
    worst = sorted(compared, key=lambda score: -(score.values.get(_WORST_BY) or 0.0))
    shown = [made for score in worst[:_MOST_PICTURES] if (made := _sheet(score, out)) is not None]
    if not shown:
        return None
    scale = picture(
        difference_scale(),
        alt="Blue at the left, gray in the middle, red at the right",
        caption="Colors of the difference: a quarter as bright, right, four times as bright",
    )
    more = len(compared) - len(shown)
    rest = f" The other {more} are in the folder pairs beside this page." if more > 0 else ""
    return Pictures(
        title="Relit scenes",
        pictures=(*shown, scale),
        note="From left to right: under the truth, under the map, and the difference of "
        "brightness. The largest irradiance errors come first." + rest,
    )


def _sheet(score: PairScore, out: Path) -> Picture | None:
    if not score.picture:
        return None
    try:
        pixels = decode_image(read_bytes(out / score.picture), what=score.picture)
    except (ItemError, StorageError):
        return None
    error, direction = (score.values.get(name) for name in (_WORST_BY, "light-vector"))
    said = (
        f"irradiance error {format_figure(error)}, light direction {format_figure(direction, '°')}"
    )
    return picture(
        pixels,
        alt=f"A matte, a glossy and a mirror ball and a bear on a floor, lit by the truth of "
        f"{score.name}, by the map, and the difference",
        caption=f"{score.name}: {said}",
        quality=_QUALITY,
    )


def _obstacles(results: PairResults) -> Text | None:
    said = [f"{s.name}: {s.obstacle}" for s in results.scores if s.obstacle]
    if results.without_truth:
        said.append(f"Without a truth: {', '.join(results.without_truth)}.")
    return Text(title="Not compared", paragraphs=tuple(said)) if said else None

"""Histograms and cumulative curves as geometry for an SVG; the page's style colors them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.report.axis import Axis, axis_of
from panokit.report.values import Chart, Series
from panokit.report.wording import format_figure

WIDTH, HEIGHT = 360, 176
_LEFT, _RIGHT, _TOP, _BOTTOM = 40, 10, 18, 26
_FEWEST_BINS, _MOST_BINS = 6, 30

Numbers = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Bar:
    """One bar of a histogram, in the SVG's units."""

    x: float
    y: float
    width: float
    height: float
    title: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Tick:
    """A labeled place on an axis, or a line across the chart."""

    at: float
    label: str
    anchor: str = "middle"


@dataclass(frozen=True, slots=True, kw_only=True)
class SeriesDrawing:
    """One set of values: bars for the first of a histogram, a path for any other."""

    label: str
    number: int
    bars: tuple[Bar, ...] = ()
    path: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeriesSummary:
    """What a chart says of one set of values, for its table."""

    label: str
    cells: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A chart as the template draws it."""

    chart: Chart
    description: str
    series: tuple[SeriesDrawing, ...]
    x_ticks: tuple[Tick, ...]
    y_ticks: tuple[Tick, ...]
    marks: tuple[Tick, ...]
    summary: tuple[SeriesSummary, ...]
    floor: float = HEIGHT - _BOTTOM
    left: float = _LEFT
    right: float = WIDTH - _RIGHT
    top: float = _TOP


SUMMARY_COLUMNS = ("Values", "Least", "5 %", "Median", "95 %", "Largest", "Not drawn")


def draw(chart: Chart) -> Drawing:
    """The geometry of a chart; one without any value to draw has empty axes."""
    counted = chart.kind in ("bins", "curve")
    kept = [_heights(s) if counted else _kept(s, log=chart.log) for s in chart.series]
    across = [np.asarray(chart.at, np.float64)] if counted else kept
    axis = axis_of(across, chart.marks, log=chart.log, span=(_LEFT, WIDTH - _RIGHT))
    if chart.kind == "histogram":
        edges = np.linspace(axis.low, axis.high, _bins(kept) + 1)
        counts = [np.histogram(axis.scaled(v), edges)[0].astype(np.float64) for v in kept]
        series, y_ticks = _histogram(chart, counts, edges, axis)
    elif chart.kind == "bins":
        series, y_ticks = _histogram(chart, kept, axis.scaled(across[0]), axis)
    else:
        series, y_ticks = _curves(chart, kept, axis)
    return Drawing(
        chart=chart,
        description=_describe(chart, kept),
        series=series,
        x_ticks=tuple(Tick(at=at, label=label) for at, label in axis.ticks),
        y_ticks=y_ticks,
        marks=tuple(_mark(mark.label, axis.place(mark.value)) for mark in axis.marks),
        summary=() if counted else tuple(map(_summary, chart.series, kept, [chart.unit] * 4)),
    )


def _bins(kept: Sequence[Numbers]) -> int:
    """A little more than Rice's rule, 2 n^(1/3), since the reader sees single maps."""
    most = max(len(values) for values in kept)
    return int(np.clip(np.ceil(2.5 * most ** (1 / 3)), _FEWEST_BINS, _MOST_BINS))


def _kept(series: Series, *, log: bool) -> Numbers:
    values = np.asarray(series.values, np.float64)
    values = values[np.isfinite(values)]
    return values[values > 0] if log else values


def _heights(series: Series) -> Numbers:
    return np.nan_to_num(np.maximum(np.asarray(series.values, np.float64), 0))


def _y(share: float) -> float:
    return round(HEIGHT - _BOTTOM - share * (HEIGHT - _BOTTOM - _TOP), 2)


def _mark(label: str, at: float) -> Tick:
    near_left, near_right = at < _LEFT + 60, at > WIDTH - _RIGHT - 60
    return Tick(
        at=at, label=label, anchor="start" if near_left else "end" if near_right else "middle"
    )


def _histogram(
    chart: Chart, counts: Sequence[Numbers], edges: Numbers, axis: Axis
) -> tuple[tuple[SeriesDrawing, ...], tuple[Tick, ...]]:
    """Shares of each series by bin: the first as bars, the others as outlines over them."""
    shares = [c / max(c.sum(), 1e-300) for c in counts]
    highest = max((float(s.max()) for s in shares if len(s)), default=0.0) or 1.0
    places = [axis.at(float(edge)) for edge in edges]
    drawn = []
    for number, (series, count, share) in enumerate(
        zip(chart.series, counts, shares, strict=True), start=1
    ):
        heights = [_y(float(s) / highest) for s in share]
        if number == 1:
            bars = tuple(
                Bar(
                    x=round(places[i] + 0.5, 2),
                    y=heights[i],
                    width=round(max(places[i + 1] - places[i] - 1, 0.5), 2),
                    height=round(_y(0) - heights[i], 2),
                    title=f"{_bin_name(chart, axis, edges[i], edges[i + 1])}: "
                    f"{count[i]:.0f} of {count.sum():.0f}",
                )
                for i in range(len(heights))
                if count[i]
            )
            drawn.append(SeriesDrawing(label=series.label, number=number, bars=bars))
        else:
            steps = [f"V{height}H{places[i + 1]}" for i, height in enumerate(heights)]
            path = "".join([f"M{places[0]} {_y(0)}", *steps, f"V{_y(0)}"])
            drawn.append(SeriesDrawing(label=series.label, number=number, path=path))
    most = max((float(c.max()) for c in counts if len(c)), default=0.0)
    top = f"{100 * highest:.0f} %" if len(counts) > 1 else f"{most:.0f}"
    return tuple(drawn), (Tick(at=_y(0), label="0"), Tick(at=_y(1), label=top))


def _bin_name(chart: Chart, axis: Axis, low: float, high: float) -> str:
    first, last = axis.unscaled(float(low)), axis.unscaled(float(high))
    return f"{format_figure(first)} to {format_figure(last, chart.unit)}"


def _curves(
    chart: Chart, kept: Sequence[Numbers], axis: Axis
) -> tuple[tuple[SeriesDrawing, ...], tuple[Tick, ...]]:
    """The share of values up to each value: as steps, or as given at points."""
    drawn = []
    for number, (series, values) in enumerate(zip(chart.series, kept, strict=True), start=1):
        path = ""
        if chart.kind == "curve" and len(values):
            points = [
                f"{axis.place(x)} {_y(float(y))}" for x, y in zip(chart.at, values, strict=True)
            ]
            path = "M" + "L".join(points)
        elif len(values):
            steps = [
                f"H{axis.place(float(value))}V{_y(rank / len(values))}"
                for rank, value in enumerate(np.sort(values), start=1)
            ]
            path = "".join([f"M{_LEFT} {_y(0)}", *steps, f"H{WIDTH - _RIGHT}"])
        drawn.append(SeriesDrawing(label=series.label, number=number, path=path))
    ticks = tuple(Tick(at=_y(s), label=f"{100 * s:.0f} %") for s in (0, 0.5, 1))
    return tuple(drawn), ticks


def _describe(chart: Chart, kept: Sequence[Numbers]) -> str:
    """The chart in one sentence for those who cannot see it."""
    kind = "Histogram" if chart.kind in ("histogram", "bins") else "Cumulative curve"
    if chart.kind in ("bins", "curve"):
        parts = [", ".join(series.label for series in chart.series)]
        if chart.at:
            ends = format_figure(chart.at[0]), format_figure(chart.at[-1], chart.unit)
            parts.append(f"From {ends[0]} to {ends[1]}")
    else:
        parts = [_in_words(s, v, chart.unit) for s, v in zip(chart.series, kept, strict=True)]
    parts += [f"{m.label}: {format_figure(m.value, chart.unit)}" for m in chart.marks]
    return f"{kind} of {chart.title}. {'. '.join(parts)}."


def _in_words(series: Series, values: Numbers, unit: str) -> str:
    if not len(values):
        return f"{series.label}: no values"
    low, middle, high = (float(q) for q in np.percentile(values, [0, 50, 100]))
    return (
        f"{series.label}: {len(values)} values from {format_figure(low)} to "
        f"{format_figure(high, unit)}, median {format_figure(middle, unit)}"
    )


def _summary(series: Series, values: Numbers, unit: str) -> SeriesSummary:
    left_out = len(series.values) - len(values)
    if not len(values):
        return SeriesSummary(label=series.label, cells=("0", *["–"] * 5, str(left_out)))
    quantiles = np.percentile(values, [0, 5, 50, 95, 100])
    figures = (format_figure(float(q), unit) for q in quantiles)
    return SeriesSummary(label=series.label, cells=(str(len(values)), *figures, str(left_out)))

"""The histograms of a dataset's card."""

import io
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa

# Column, title, lowest and highest value shown (None: those of the data).
_HISTOGRAMS = (
    ("roughness", "roughness of the material", 0.0, 1.0),
    ("light_elevation_deg", "elevation of most light, degrees", -90.0, 90.0),
    ("light_directedness", "how directed the light is (1: one lamp)", 0.0, 1.0),
    ("exposure_stops", "exposure off the meter, stops", None, None),
    ("mask_share", "how much the object covers", 0.0, None),
    ("object_median", "median of the object (white: 1)", 0.0, None),
)
_BARS = (("probe_kind", "kind of map"), ("object_kind", "kind of object"))
_BINS = 36
_INK, _FILL, _GRID = "#333333", "#4a7ba6", "#dddddd"


def draw_histograms(table: pa.Table) -> bytes:
    """A PNG of eight small diagrams: kinds of maps and objects, materials, light, exposure.

    Args:
        table: The index of a dataset, with at least one row.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12, 5.2), dpi=100, layout="constrained")
    axes = figure.subplots(2, 4)
    for axis, (column, title) in zip(axes[:, 0], _BARS, strict=True):
        _draw_bars(axis, table.column(column).to_pylist())
        axis.set_title(title, fontsize=9, color=_INK, loc="left")
    for axis, (column, title, low, high) in zip(axes[:, 1:].flat, _HISTOGRAMS, strict=True):
        values = np.array(table.column(column).drop_null().to_pylist(), float)
        _draw_histogram(axis, values, low, high)
        axis.set_title(title, fontsize=9, color=_INK, loc="left")
    for axis in axes.flat:
        axis.tick_params(labelsize=8, colors=_INK, length=2)
        for side in ("top", "right"):
            axis.spines[side].set_visible(False)
    buffer = io.BytesIO()
    FigureCanvasAgg(figure).print_png(buffer, metadata={"Software": None})
    return buffer.getvalue()


def _draw_bars(axis: Any, values: Sequence[Any]) -> None:
    counts = Counter(str(value) for value in values).most_common()
    names = [name for name, _ in counts][::-1]
    axis.barh(names, [counts[-1 - i][1] for i in range(len(names))], color=_FILL, height=0.7)
    axis.grid(axis="x", color=_GRID, linewidth=0.6)
    axis.set_axisbelow(True)


def _draw_histogram(
    axis: Any, values: "np.ndarray[Any, Any]", low: float | None, high: float | None
) -> None:
    if len(values) == 0:
        axis.text(0.5, 0.5, "no values", ha="center", va="center", fontsize=8, color=_INK)
        axis.set_xticks([])
        axis.set_yticks([])
        return
    ends = (values.min() if low is None else low, values.max() if high is None else high)
    if ends[1] <= ends[0]:
        ends = (ends[0] - 0.5, ends[0] + 0.5)
    axis.hist(values, bins=_BINS, range=ends, color=_FILL)
    axis.set_xlim(ends)
    axis.grid(axis="y", color=_GRID, linewidth=0.6)
    axis.set_axisbelow(True)
    axis.locator_params(axis="y", integer=True, nbins=4)

"""A picture of where a map lies among captured maps: one row of dots for each figure."""

import io

import numpy as np

from panokit.qa.plausibility import deviations, place
from panokit.qa.reference_set import ReferenceSet

_LABELS = {
    "top-share": "energy of the brightest 0.1 %",
    "peak-over-median": "peak over median",
    "contrast": "contrast",
    "anisotropy": "anisotropy",
    "upper-share": "light from above",
    "degree-1": "harmonics of degree 1",
    "degree-2": "harmonics of degree 2",
    "degree-3-4": "harmonics of degrees 3 and 4",
    "degree-5-8": "harmonics of degrees 5 to 8",
}
_INK, _OTHERS, _OWN = "#333333", "#9fb4c7", "#c0392b"
_REACH = 6.0


def draw_plausibility(figures: dict[str, float], reference: ReferenceSet, title: str = "") -> bytes:
    """A PNG: the maps of the nearest category as gray dots, this map as a red one.

    Args:
        figures: Of the map, from `plausibility_figures`.
        reference: The maps it is placed among.
        title: Of the picture, such as the map's name.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    found = place(figures, reference)
    maps = reference.categories[found.category]
    own = np.array([figures[name] for name in reference.figures])
    theirs = np.clip(deviations(maps, maps), -_REACH, _REACH)
    off = np.clip(deviations(own, maps), -_REACH, _REACH)
    figure = Figure(figsize=(6.4, 3.4), dpi=120, layout="constrained")
    axis = figure.subplots()
    rows = np.arange(len(own))[::-1]
    for column, row in enumerate(rows):
        axis.plot(theirs[:, column], np.full(len(maps), row), "o", color=_OTHERS, ms=4, alpha=0.7)
    axis.plot(off, rows, "D", color=_OWN, ms=6, label="this map")
    axis.axvspan(-1, 1, color=_OTHERS, alpha=0.15, lw=0)
    axis.set_yticks(rows, [_LABELS.get(name, name) for name in reference.figures], fontsize=8)
    axis.set_xlim(-_REACH - 0.4, _REACH + 0.4)
    axis.set_xlabel(
        f"robust standard deviations from the middle of {len(maps)} {found.category} maps",
        fontsize=8,
        color=_INK,
    )
    axis.tick_params(axis="x", labelsize=8)
    axis.set_title(
        f"{title}{': ' if title else ''}distance {found.distance:.1f}, "
        f"{found.score:.0f} % lie farther out",
        fontsize=9,
        loc="left",
        color=_INK,
    )
    for side in ("top", "right", "left"):
        axis.spines[side].set_visible(False)
    buffer = io.BytesIO()
    # Without the date and the version in it, equal figures give equal bytes.
    FigureCanvasAgg(figure).print_png(buffer, metadata={"Software": None})
    return buffer.getvalue()

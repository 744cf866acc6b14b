"""F5.1 to F5.6: validation error over epochs, with seeds as bands."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.evaluate.lighting.figures.drawing import (
    BAND,
    COLORS,
    DASHES,
    FigureFile,
    finished,
    label,
    legend,
    panel,
)
from panokit.evaluate.lighting.model_tables import CURVES
from panokit.evaluate.lighting.outcome import Outcome

_TITLES = {
    "F5.1": "Shared and unshared weights, deep",
    "F5.2": "Concatenation and dot product, deep",
    "F5.3": "Concatenation and dot product, shallow",
    "F5.4": "Without and with the background",
    "F5.5": "Composited background and a branch of its own",
    "F5.6": "One similarity and a pyramid of them",
}
_LEAST_SEEDS_FOR_BAND = 3


def draw_curves(outcome: Outcome) -> list[FigureFile]:
    """The figures whose experiments are there, all with the same axes."""
    found: dict[str, list[tuple[str, NDArray[np.float64], bool]]] = {}
    for id_, names in CURVES.items():
        for size in outcome.sizes:
            series = []
            for name in names:
                entrant = outcome.entrant(name, size)
                curves = outcome.curves(entrant) if entrant else np.zeros((0, 0))
                if entrant is not None and curves.size:
                    series.append((entrant.title, curves, bool(outcome.not_converged(entrant))))
            if len(series) >= 2:
                found[id_ if size == outcome.sizes[0] else f"{id_} {size}"] = series
    if not found:
        return []
    every = [curves for series in found.values() for _, curves, _ in series]
    # The first epochs say little and would squeeze all others.
    low = min(float(one.min()) for one in every)
    high = max(float(one[:, min(1, one.shape[1] - 1) :].max()) for one in every)
    last = max(one.shape[1] for one in every)
    return [
        _drawn(id_, series, (0.97 * low, 1.05 * high), last) for id_, series in found.items()
    ]  # fmt: skip


def _drawn(
    id_: str,
    series: list[tuple[str, NDArray[np.float64], bool]],
    limits: tuple[float, float],
    last: int,
) -> FigureFile:
    figure, axis = panel()
    for number, (title, curves, unfinished) in enumerate(series):
        epochs = np.arange(1, curves.shape[1] + 1)
        color, dash = COLORS[number], DASHES[number % len(DASHES)]
        if len(curves) >= _LEAST_SEEDS_FOR_BAND:
            axis.fill_between(epochs, curves.min(axis=0), curves.max(axis=0), color=color,
                              alpha=BAND, lw=0)  # fmt: skip
            axis.plot(epochs, curves.mean(axis=0), dash, color=color, lw=1.5,
                      label=_label(title, unfinished))  # fmt: skip
        else:
            for which, curve in enumerate(curves):
                axis.plot(epochs, curve, dash, color=color, lw=1.2,
                          label=_label(title, unfinished) if which == 0 else None)  # fmt: skip
    axis.set_yscale("log")
    axis.set_ylim(limits)
    axis.set_xlim(1, last)
    _plain_ticks(axis, limits)
    label(axis, "epoch", "validation SSD of code values")
    legend(axis, loc="upper right")
    seeds = sorted({len(curves) for _, curves, _ in series})
    seeds_told = f"{' and '.join(map(str, seeds))} seed{'s' * (seeds[-1] > 1)}"
    if seeds[-1] >= _LEAST_SEEDS_FOR_BAND:
        seeds_told += ": the line is their mean, the band reaches from the least to the most"
    return finished(
        figure,
        id_=id_,
        title=_TITLES[id_.split(" ")[0]],
        caption="Sum of squared differences of code values for a validation sample, after each "
        f"epoch; {seeds_told}. All six figures have the same axes; the first epoch may lie above."
        + (" ~: not converged." if any(unfinished for *_, unfinished in series) else ""),
    )


def _label(title: str, unfinished: bool) -> str:
    return f"{title} ~" if unfinished else title


def _plain_ticks(axis: Any, limits: tuple[float, float]) -> None:
    """Plain numbers, as many as are read easily."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    ticks: list[float] = []
    for bases in ((1, 1.5, 2, 3, 5, 7), (1, 1.2, 1.4, 1.6, 1.8, 2, 2.5, 3, 3.5, *range(4, 10))):
        steps = [base * 10.0**power for power in range(-3, 7) for base in bases]
        ticks = ticks if len(ticks) > 2 else [s for s in steps if limits[0] <= s <= limits[1]]
    axis.yaxis.set_major_locator(FixedLocator(ticks))
    axis.yaxis.set_minor_locator(NullLocator())
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))

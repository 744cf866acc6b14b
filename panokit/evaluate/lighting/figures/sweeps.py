"""F-D, F-E and F-F: normals that are off, memory, and spoiled inputs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.evaluate.lighting.controls import CONTROLS, NORMALS
from panokit.evaluate.lighting.experiments import FINAL, experiment
from panokit.evaluate.lighting.figures.drawing import (
    BAND,
    COLORS,
    INK,
    WIDTH_IN,
    FigureFile,
    finished,
    label,
    legend,
    panel,
)
from panokit.evaluate.lighting.figures.spread import featured
from panokit.evaluate.lighting.model_tables import control_changes
from panokit.evaluate.lighting.outcome import Outcome
from panokit.evaluate.lighting.run import TO_MEMORY, TO_TRUTH
from panokit.evaluate.lighting.statements import PRIMARY
from panokit.evaluate.lighting.verdicts import resampled_means

LEVELS_DEG = (0.0, 10.0, 20.0, 30.0)
_SHORT_CONTROLS = {
    "right is left": "left view twice", "exchanged": "views exchanged",
    "right shifted": "right view moved", "right of another": "right view of another",
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NoiseCurve:
    """A figure against the error of normals, relative to that with true normals.

    Attributes:
        levels_deg: Mean errors of the normals.
        change: Relative change of the mean score at each, (levels,).
        low: Lower ends of 95 % intervals.
        high: Upper ends.
        rival: The title of the model without normals.
        rival_change: Its score relative to that with true normals.
        rival_interval: Of it.
        crossing_deg: Where the curve meets the rival; infinite where it does not.
        crossing_interval: 95 % interval of it.
        untrained: The same curve of the model that knows only true normals; NaN where not judged.
    """

    levels_deg: tuple[float, ...]
    change: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    rival: str
    rival_change: float
    rival_interval: tuple[float, float]
    crossing_deg: float
    crossing_interval: tuple[float, float]
    untrained: NDArray[np.float64]

    def crossing_text(self) -> str:
        """Where the curves cross, in words."""
        if np.isinf(self.crossing_deg):
            said = f"it does not cross {self.rival} up to {self.levels_deg[-1]:g}°"
        elif self.crossing_deg == 0:
            said = f"{self.rival} is better with true normals already"
        else:
            said = f"it crosses {self.rival} at {self.crossing_deg:.1f}°"
        ends = [f"{one:.1f}°" if np.isfinite(one) else f"beyond {self.levels_deg[-1]:g}°"
                for one in self.crossing_interval]  # fmt: skip
        return f"{said} (95 % interval {ends[0]} to {ends[1]})"


def noise_curve(outcome: Outcome, base: str, rival: str, figure: str) -> NoiseCurve | None:
    """The curve of an experiment and its variants with noise; None where they are not there.

    Args:
        outcome: The evaluation.
        base: The experiment with true normals.
        rival: The experiment that needs none.
        figure: Lower is better.
    """
    names = [base if level == 0 else f"{base}-noise-{level:g}" for level in LEVELS_DEG]
    there = [(level, entrant) for level, name in zip(LEVELS_DEG, names, strict=True)
             if (entrant := outcome.entrant(name)) is not None]  # fmt: skip
    other = outcome.entrant(rival)
    if other is None or len(there) < 2 or there[0][0] != 0:
        return None
    levels = tuple(level for level, _ in there)
    rows = np.stack([outcome.scores(one, figure) for one in (*(e for _, e in there), other)])
    finite = np.isfinite(rows).all(axis=0)
    if not finite.any():
        return None
    rows = rows[:, finite]
    places = np.asarray(np.unique(outcome.places[finite], return_inverse=True)[1], np.int64)
    drawn = resampled_means(rows, places)
    drawn = drawn / drawn[0] - 1
    means = rows.mean(axis=1) / rows[0].mean() - 1
    low, high = np.percentile(drawn, [2.5, 97.5], axis=1)
    crossings = np.array([crossing(levels, one[:-1], one[-1]) for one in drawn.T])
    ends = np.percentile(crossings, [2.5, 97.5], method="nearest")
    return NoiseCurve(
        levels_deg=levels,
        change=means[:-1],
        low=low[:-1],
        high=high[:-1],
        rival=other.title,
        rival_change=float(means[-1]),
        rival_interval=(float(low[-1]), float(high[-1])),
        crossing_deg=crossing(levels, means[:-1], float(means[-1])),
        crossing_interval=(float(ends[0]), float(ends[1])),
        untrained=_untrained(outcome, base, figure, levels),
    )


def crossing(levels: tuple[float, ...], curve: NDArray[np.float64], height: float) -> float:
    """Where a curve first reaches a height, between levels linearly; infinite if nowhere."""
    if curve[0] >= height:
        return levels[0]
    for left, right, a, b in zip(levels, levels[1:], curve, curve[1:], strict=False):
        if b >= height:
            return float(left + (right - left) * (height - a) / (b - a))
    return float("inf")


def _untrained(
    outcome: Outcome, base: str, figure: str, levels: tuple[float, ...]
) -> NDArray[np.float64]:
    entrant = outcome.entrant(base)
    changes = np.full(len(levels), np.nan)
    if entrant is None:
        return changes
    plain = outcome.scores(entrant, figure)
    changes[0] = 0.0
    for number, level in enumerate(levels[1:], start=1):
        spoiled = outcome.scores(entrant, figure, NORMALS.get(level, "-"))
        both = np.isfinite(plain) & np.isfinite(spoiled)
        if both.any():
            changes[number] = spoiled[both].mean() / plain[both].mean() - 1
    return changes


# Base, rival, figure, title.
NOISE = (
    ("dematerial", FINAL, PRIMARY, "light"),
    ("dense-reflectance", "picture-reflectance", "reflectance-code-ssd", "reflectance"),
)


def draw_noise(outcome: Outcome) -> list[FigureFile]:
    """F-D: how much worse networks on reflectance maps are with normals that are off."""
    found = []
    for number, (base, rival, name, of_what) in enumerate(NOISE):
        curve = noise_curve(outcome, base, rival, name)
        if curve is None:
            continue
        figure, axis = panel()
        axis.fill_between(curve.levels_deg, 100 * curve.low, 100 * curve.high, color=COLORS[2],
                          alpha=BAND, lw=0)  # fmt: skip
        axis.plot(curve.levels_deg, 100 * curve.change, "o-", color=COLORS[2], ms=4, lw=1.5,
                  label="trained with such normals")  # fmt: skip
        if np.isfinite(curve.untrained[1:]).any():
            axis.plot(curve.levels_deg, 100 * curve.untrained, "s--", color=COLORS[3], ms=3.5,
                      lw=1.2, label="trained with true normals")  # fmt: skip
        ends = [100 * one for one in curve.rival_interval]
        axis.axhspan(*ends, color=COLORS[0], alpha=BAND * 0.7, lw=0)
        axis.axhline(100 * curve.rival_change, color=COLORS[0], lw=1.2, ls="-.",
                     label=f"{curve.rival}, no normals")  # fmt: skip
        if np.isfinite(curve.crossing_deg) and curve.crossing_deg > 0:
            axis.axvline(curve.crossing_deg, color=INK, lw=0.8, ls=":")
        axis.set_xticks(curve.levels_deg)
        label(axis, "mean error of normals, °", "SSD against true normals, %")
        legend(axis, loc="best")
        text = curve.crossing_text()
        found.append(finished(
            figure,
            id_=f"F-D{'ab'[number]}",
            title=f"Normals that are off: {of_what} from reflectance maps",
            caption=f"{experiment(base).title}, and the same trained with normals that are off, "
            f"against a network that needs none: {text}. Bands: 95 % intervals by drawing places "
            "anew.",
        ))  # fmt: skip
    return found


def draw_memory(outcome: Outcome) -> list[FigureFile]:
    """F-E: each prediction's distance to its truth and to the nearest training map."""
    several = [e for e in featured(outcome, 4) if outcome.has(e.members[0], TO_MEMORY)]
    oracle = outcome.entrant("nearest map (oracle)")
    several = [e for e in several if not e.is_baseline][:3] + ([oracle] if oracle else [])
    several = [e for e in several if outcome.has(e.members[0], TO_MEMORY)]
    if not several:
        return []
    pairs = [(outcome.scores(e, TO_TRUTH), outcome.scores(e, TO_MEMORY)) for e in several]
    most = 1.04 * max(float(np.nanmax(values)) for pair in pairs for values in pair)
    figure, axes = panel(width_in=2.1 * len(several) + 0.3, height_in=2.5, columns=len(several))
    for axis, entrant, (truth, known) in zip(np.atleast_1d(axes), several, pairs, strict=True):
        axis.plot([0, most], [0, most], color=INK, lw=0.7, ls=":")
        dot = 2.2 if len(truth) > 300 else 4.5
        axis.plot(truth, known, ".", color=COLORS[0], ms=dot, alpha=0.5, mew=0)
        axis.set_xlim(0, most)
        axis.set_ylim(-0.03 * most, most)
        axis.set_title(f"{entrant.title}: {100 * float(np.mean(known < truth)):.0f} %",
                       fontsize=8, color=INK)  # fmt: skip
        label(axis, "to the truth")
    np.atleast_1d(axes)[0].set_ylabel("to the nearest training map", fontsize=8.5, color=INK)
    return [finished(
        figure,
        id_="F-E",
        title="Memory: nearer to the truth, or to a training map?",
        caption="Root mean squared difference of logs, decades, a dot for each sample; below the "
        "dotted line a prediction is nearer to a training map than to its truth, as told in %.",
        wide=True,
    )]  # fmt: skip


def draw_controls(outcome: Outcome) -> list[FigureFile]:
    """F-F: what a spoiled second view does to each stereo network."""
    changes = [one for one in control_changes(outcome) if one[1] in CONTROLS]
    if not changes:
        return []
    titles = list(dict.fromkeys(title for title, *_ in changes))
    figure, axis = panel(width_in=WIDTH_IN, height_in=1.0 + 0.3 * len(titles))
    names = list(CONTROLS)
    for title, control, change, low, high, _ in changes:
        number = names.index(control)
        row = len(titles) - 1 - titles.index(title) + 0.17 * (1.5 - number)
        axis.plot([100 * low, 100 * high], [row, row], color=COLORS[number], lw=1.2, alpha=0.8)
        axis.plot([100 * change], [row], "osD^"[number], color=COLORS[number], ms=3.6,
                  label=_SHORT_CONTROLS[control] if title == titles[0] else None)  # fmt: skip
    axis.axvline(0, color=INK, lw=0.8)
    axis.set_yticks(range(len(titles)), titles[::-1], fontsize=7.5)
    axis.grid(axis="y", visible=False)
    label(axis, "change of SSD of code values, %")
    legend(axis, loc="lower center", bbox_to_anchor=(0.4, 1.0), ncols=2)
    n = max(one[-1] for one in changes)
    return [finished(
        figure,
        id_="F-F",
        title="Is the second view used?",
        caption=f"What happens to the error where the second view is spoiled, n = {n}; lines are "
        "95 % intervals by drawing places anew. To the right of zero: the network misses it.",
    )]  # fmt: skip

"""F5.7 to F5.10: the scores of all entrants, and how those of some are distributed."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from panokit.evaluate.lighting.comparison_tables import strata_of
from panokit.evaluate.lighting.experiments import FEATURED
from panokit.evaluate.lighting.figures.drawing import (
    COLORS,
    DASHES,
    INK,
    FigureFile,
    finished,
    label,
    legend,
    panel,
)
from panokit.evaluate.lighting.outcome import Entrant, Outcome
from panokit.evaluate.lighting.statements import PRIMARY

_GROUP_COLORS = {
    "stereo": COLORS[0], "panokit": COLORS[1], "reflectance map": COLORS[2],
    "augmented": COLORS[3], "baseline": COLORS[7], "reflectance": COLORS[4],
}  # fmt: skip
# The mean of its final model (Parker 2018, figure 5.9).
_THESIS_DSSIM = 0.34
_MOST_FEATURED = 4
_BINS = 40


def featured(outcome: Outcome, most: int = _MOST_FEATURED) -> list[Entrant]:
    """The entrants that figures of single models show."""
    found = [outcome.entrant(name) for name in FEATURED]
    chosen = [one for one in found if one is not None]
    # In an evaluation without them: the best by the primary figure.
    rest = [e for e in outcome.entrants_with(PRIMARY) if e not in chosen and not e.is_baseline]
    rest.sort(key=lambda one: float(np.nanmean(outcome.scores(one, PRIMARY))))
    models = [one for one in chosen if not one.is_baseline]
    if len(models) < 2:
        chosen = [*models, *rest[: 2 - len(models)], *(e for e in chosen if e.is_baseline)]
    return [e for e in chosen if outcome.has(e.members[0], PRIMARY)][:most]


def draw_bars(outcome: Outcome) -> list[FigureFile]:
    """F5.7: DSSIM of every entrant, of radiance and of its logs."""
    captions = {
        "thesis-dssim": ("F5.7", "DSSIM of radiance", _THESIS_DSSIM),
        "thesis-dssim-log": ("F5.7 log", "DSSIM of logs of radiance", None),
        PRIMARY: ("F5.7 SSD", "SSD of code values", None),
    }
    return [
        _bars(outcome, name, id_, title, thesis)
        for name, (id_, title, thesis) in captions.items()
        if outcome.entrants_with(name)
    ]  # fmt: skip


def _bars(outcome: Outcome, name: str, id_: str, title: str, thesis: float | None) -> FigureFile:
    entrants = outcome.entrants_with(name)
    spreads = {one.name: outcome.spread(one, name) for one in entrants}
    entrants = sorted((e for e in entrants if spreads[e.name] is not None),
                      key=lambda one: spreads[one.name].mean, reverse=True)  # type: ignore[union-attr]  # fmt: skip
    figure, axis = panel(height_in=0.8 + 0.19 * len(entrants))
    for row, entrant in enumerate(entrants):
        s, color = spreads[entrant.name], _GROUP_COLORS[entrant.about.group]
        if s is None:
            continue
        axis.plot([s.low, s.high], [row, row], color=color, lw=1.4, alpha=0.8)
        axis.plot([s.mean], [row], "o", color=color, ms=4.2)
        for member in entrant.members if len(entrant.members) > 1 else ():
            axis.plot([float(np.nanmean(outcome.values(member, name)))], [row + 0.3], "|",
                      color=color, ms=4, mew=0.8)  # fmt: skip
    axis.set_yticks(range(len(entrants)), [_short(one.title) for one in entrants], fontsize=7)
    axis.set_ylim(-0.7, len(entrants) - 0.3)
    axis.grid(axis="y", visible=False)
    if thesis is not None:
        axis.axvline(thesis, color=INK, lw=0.8, ls=":")
        axis.text(
            thesis, len(entrants) - 0.35, f" thesis {thesis:.2f}", fontsize=6.5, color=INK, va="top"
        )
    label(axis, title)
    told = "; the dotted line is the thesis's mean on other data" if thesis is not None else ""
    return finished(
        figure,
        id_=id_,
        title=f"{title} of all entrants",
        caption=f"{len(outcome.keys)} samples. Dots are means, lines their 95 % intervals by "
        "drawing places anew, small strokes "
        "single seeds. Blue: stereo; green: reflectance maps; orange: panokit; gray: no training"
        f"{told}. Lower is better.",
    )


def _short(title: str) -> str:
    return title if len(title) <= 34 else f"{title[:33]}…"


def draw_distributions(outcome: Outcome) -> list[FigureFile]:
    """F5.8 and F5.9: how MSE and DSSIM are distributed, on one axis for all."""
    several = featured(outcome)
    return [
        _histogram(outcome, several, "thesis-mse", "F5.8", "MSE of radiance", log=True),
        _histogram(outcome, several, "thesis-dssim", "F5.9", "DSSIM of radiance", log=False),
    ]  # fmt: skip


def _histogram(
    outcome: Outcome, several: Sequence[Entrant], name: str, id_: str, title: str, *, log: bool
) -> FigureFile:
    values = [_finite(outcome, one, name) for one in several]
    every = np.concatenate(values)
    bins = min(_BINS, 4 + len(values[0]) // 5)
    if log:
        low, high = np.log10(np.maximum([every.min(), every.max()], 1e-4))
        edges = np.logspace(low - 0.02, high + 0.02, bins + 1)
    else:
        edges = np.linspace(0, float(every.max()) * 1.02, bins + 1)
    figure, axis = panel()
    for number, (entrant, own) in enumerate(zip(several, values, strict=True)):
        heights = np.histogram(np.maximum(own, edges[0]), edges)[0] / len(own) * 100
        axis.stairs(heights, edges, color=COLORS[number], lw=1.4,
                    ls=DASHES[number % len(DASHES)], label=entrant.title)  # fmt: skip
        axis.plot(np.percentile(own, [25, 50, 75]), [0.035 + 0.045 * number] * 3, "|-",
                  color=COLORS[number], ms=5, lw=1,
                  transform=axis.get_xaxis_transform())  # fmt: skip
    if log:
        axis.set_xscale("log")
    highest = axis.get_ylim()[1]
    room = 0.05 * (len(several) + 1)
    axis.set_ylim(-highest * room / (1 - room), highest)
    axis.set_yticks([tick for tick in axis.get_yticks() if 0 <= tick <= highest])
    label(axis, title, "% of samples")
    legend(axis, loc="lower left", bbox_to_anchor=(0, 1), ncols=2)
    return finished(
        figure,
        id_=id_,
        title=f"{title}: how it is distributed",
        caption=f"{len(every) // len(several)} samples each. Below the axis: 25th, 50th and 75th "
        "percentile.",
    )


def draw_brightest(outcome: Outcome) -> list[FigureFile]:
    """F5.10: the share of samples whose brightest pixel is within an angle, by kind of light."""
    several = featured(outcome)
    groups = strata_of(outcome)
    chosen = {name: which for name, which in groups.items()
              if name in ("all", "dominant light", "none") and which.any()}  # fmt: skip
    captions = {"all": "all samples", "dominant light": "one dominant light",
                "none": "no dominant light"}  # fmt: skip
    found = []
    for number, (name, which) in enumerate(chosen.items()):
        figure, axis = panel()
        for index, entrant in enumerate(several):
            own = outcome.scores(entrant, "brightest")[which]
            _ecdf(axis, own[np.isfinite(own)], COLORS[index], DASHES[index % len(DASHES)],
                  entrant.title)  # fmt: skip
        chance = np.linspace(0, 180, 181)
        axis.plot(chance, 50 * (1 - np.cos(np.deg2rad(chance))), color=INK, lw=0.7, ls=":",
                  label="chance")  # fmt: skip
        axis.set_xlim(0, 180)
        axis.set_ylim(0, 100)
        axis.set_xticks(range(0, 181, 30))
        label(axis, "angle between brightest pixels, °", "% of samples within it")
        legend(axis, loc="lower right")
        found.append(finished(
            figure,
            id_=f"F5.10{'abc'[number]}",
            title=f"Brightest pixel: {captions[name]}",
            caption=f"{int(which.sum())} samples. Dotted: a direction by chance.",
        ))  # fmt: skip
    return found


def _ecdf(axis: Any, values: np.ndarray, color: str, dash: str, title: str) -> None:
    if len(values):
        steps = np.sort(values)
        axis.step(np.concatenate([[0], steps, [180]]),
                  np.concatenate([[0], np.arange(1, len(steps) + 1), [len(steps)]])
                  * 100 / len(steps), dash, where="post", color=color, lw=1.4,
                  label=title)  # fmt: skip


def _finite(outcome: Outcome, entrant: Entrant, name: str) -> np.ndarray:
    values = outcome.scores(entrant, name)
    return values[np.isfinite(values)]

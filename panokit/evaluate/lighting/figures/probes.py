"""T-K: the light of the splits."""

import numpy as np

from panokit.evaluate.lighting.figures.drawing import (
    COLORS,
    DASHES,
    FigureFile,
    finished,
    label,
    legend,
    panel,
)
from panokit.evaluate.lighting.outcome import Outcome

_AXES = {
    "light_elevation_deg": ("T-K elevation", "elevation of most light, °"),
    "light_directedness": ("T-K directedness", "how directed the light is (1: a single lamp)"),
}


def draw_probes(outcome: Outcome) -> list[FigureFile]:
    """How high and how directed the light is in each split."""
    found = []
    for name, (id_, title) in _AXES.items():
        splits = {
            split: facts["histograms"][name]
            for split, facts in outcome.dataset.get("splits", {}).items()
            if sum(facts["histograms"].get(name, {}).get("counts", ()))
        }
        if not splits:
            continue
        figure, axis = panel()
        for number, (split, histogram) in enumerate(splits.items()):
            counts = np.array(histogram["counts"], float)
            axis.stairs(100 * counts / counts.sum(), histogram["edges"], color=COLORS[number],
                        lw=1.4, ls=DASHES[number], label=split)  # fmt: skip
        label(axis, title, "% of samples")
        legend(axis)
        found.append(finished(
            figure, id_=id_, title=f"The light of the splits: {title.partition(',')[0]}",
            caption="Few places in a split make steep histograms.",
        ))  # fmt: skip
    return found

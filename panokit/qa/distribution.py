"""Where a map lies among reference maps that show other places."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from panokit.color.luminance import luminance
from panokit.envmap import EnvironmentMap
from panokit.qa.radiometry import dynamic_range_stops, top_share
from panokit.sphere import energy, light_vector


def anisotropy(envmap: EnvironmentMap) -> float | None:
    """The length of the light vector over the energy: 0 for even light, 1 for one small lamp."""
    total = float(luminance(energy(envmap.radiance)))
    return float(np.linalg.norm(light_vector(envmap.radiance))) / total if total > 0 else None


def upper_share(envmap: EnvironmentMap) -> float | None:
    """The share of the energy that comes from above the horizon."""
    total = float(luminance(energy(envmap.radiance)))
    if total <= 0:
        return None
    upper = np.where(
        (np.arange(envmap.height_px) < envmap.height_px // 2)[:, None, None],
        envmap.radiance,
        np.float32(0),
    )
    return float(luminance(energy(upper))) / total


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A figure that does not depend on a map's scale, so that any two maps compare."""

    name: str
    unit: str
    meaning: str
    of: Callable[[EnvironmentMap], float | None]


FIGURES: tuple[Figure, ...] = (
    Figure(
        name="dynamic-range",
        unit="stops",
        meaning="From the median to the peak.",
        of=dynamic_range_stops,
    ),
    Figure(
        name="top-share",
        unit="",
        meaning="Energy from the brightest 0.1 % of the sphere.",
        of=top_share,
    ),
    Figure(
        name="anisotropy",
        unit="",
        meaning="0 for light from everywhere, 1 for one small lamp.",
        of=anisotropy,
    ),
    Figure(
        name="upper-share",
        unit="",
        meaning="Energy from above the horizon.",
        of=upper_share,
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """One figure of a map beside the same figure of the reference maps.

    Attributes:
        name: Of the figure.
        value: Of the map.
        unit: Of value and limits.
        meaning: What the figure says.
        percentile: The share of reference maps below it, 0 to 100; ties count half.
        low: The references' 5th percentile.
        median: The references' median.
        high: The references' 95th percentile.
    """

    name: str
    value: float
    unit: str
    meaning: str
    percentile: float
    low: float
    median: float
    high: float

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {k: v for k, v in asdict(self).items() if k != "meaning"}


def scale_free_figures(envmap: EnvironmentMap) -> dict[str, float | None]:
    """The figures of `FIGURES`, by name."""
    return {figure.name: figure.of(envmap) for figure in FIGURES}


def standings(
    figures: Mapping[str, float | None], references: Iterable[Mapping[str, float | None]]
) -> tuple[Standing, ...]:
    """Where a map's figures lie among those of the references.

    Args:
        figures: Of the map, from `scale_free_figures`.
        references: Of each reference map.
    """
    population = list(references)
    found = []
    for figure in FIGURES:
        value = figures.get(figure.name)
        others = np.array([v for r in population if (v := r.get(figure.name)) is not None])
        if value is None or not len(others):
            continue
        below = np.count_nonzero(others < value) + 0.5 * np.count_nonzero(others == value)
        low, median, high = (float(p) for p in np.percentile(others, [5, 50, 95]))
        found.append(
            Standing(
                name=figure.name,
                value=value,
                unit=figure.unit,
                meaning=figure.meaning,
                percentile=float(100 * below / len(others)),
                low=low,
                median=median,
                high=high,
            )
        )
    return tuple(found)

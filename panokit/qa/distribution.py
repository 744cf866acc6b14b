"""Where a map lies among reference maps that show other places."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
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


# All are free of scale: relative maps of any exposure can be compared.
FIGURES: Mapping[str, tuple[str, Callable[[EnvironmentMap], float | None]]] = {
    "dynamic-range": ("stops", dynamic_range_stops),
    "top-share": ("", top_share),
    "anisotropy": ("", anisotropy),
    "upper-share": ("", upper_share),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """One figure of a map beside the same figure of the reference maps.

    Attributes:
        name: Of the figure.
        value: Of the map.
        unit: Of value and limits.
        percentile: The share of reference maps below it, 0 to 100; ties count half.
        low: The references' 5th percentile.
        median: The references' median.
        high: The references' 95th percentile.
    """

    name: str
    value: float
    unit: str
    percentile: float
    low: float
    median: float
    high: float

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {name: getattr(self, name) for name in self.__slots__}


def scale_free_figures(envmap: EnvironmentMap) -> dict[str, float | None]:
    """The figures of `FIGURES`, by name."""
    return {name: measure(envmap) for name, (_, measure) in FIGURES.items()}


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
    for name, (unit, _) in FIGURES.items():
        value = figures.get(name)
        others = np.array([v for r in population if (v := r.get(name)) is not None])
        if value is None or not len(others):
            continue
        below = np.count_nonzero(others < value) + 0.5 * np.count_nonzero(others == value)
        low, median, high = (float(p) for p in np.percentile(others, [5, 50, 95]))
        found.append(
            Standing(
                name=name,
                value=value,
                unit=unit,
                percentile=float(100 * below / len(others)),
                low=low,
                median=median,
                high=high,
            )
        )
    return tuple(found)

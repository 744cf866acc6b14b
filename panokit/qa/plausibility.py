"""Where a map lies among captured maps: how its light is spread, in figures without scale.

Nothing here is a defect by itself. A map far outside of everything that was captured is worth a
look: a lamp a thousand times too bright, a sky that was stretched, a render taken for a probe.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.qa.daylight import energy_of_halves
from panokit.qa.encoding import contrast_octaves
from panokit.qa.measurements import SMALL_WIDTH_PX, Finding, Measurements, absent
from panokit.qa.radiometry import top_share
from panokit.qa.reference_set import ReferenceSet, shipped_reference
from panokit.sphere import harmonics_degrees, light_vector, project_harmonics

FIGURES = (
    "top-share", "peak-over-median", "contrast", "anisotropy", "upper-share",
    "degree-1", "degree-2", "degree-3-4", "degree-5-8",
)  # fmt: skip
_ORDER = 8
_BANDS = {"degree-1": (1, 1), "degree-2": (2, 2), "degree-3-4": (3, 4), "degree-5-8": (5, 8)}
# Shares are compared by their odds: 0.98 to 0.99 is as far as 0.01 to 0.02.
_LEAST_SHARE = 1e-4
_LEAST_POWER = 2.0**-6
_MAD_TO_SIGMA = 1.4826
# A figure that is all but the same in the reference maps must not decide alone.
_LEAST_SPREAD = 0.25
# Nor may one figure make a map infinitely odd.
_MOST_DEVIATIONS = 10.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Placement:
    """Where a map lies among reference maps.

    Attributes:
        category: Of the reference maps that it lies nearest to.
        distance: From their middle: the root mean square over the figures, in robust standard
            deviations of that category. 1 is typical.
        score: The share of that category's maps, in percent, that lie farther out.
        percentiles: Figure -> the share of the category's maps below it, in percent.
        oddest: The figure that is farthest out.
    """

    category: str
    distance: float
    score: float
    percentiles: dict[str, float]
    oddest: str


def plausibility(measured: Measurements) -> Finding:
    """The distance of a map from the nearest category of reference maps; see `Placement`."""
    figures = plausibility_figures(measured)
    if figures is None:
        return absent(f"the map is black, or narrower than {SMALL_WIDTH_PX} pixels")
    found = place(figures, measured.reference or shipped_reference())
    note = (
        f"nearest to {found.category} maps, farther out than {100 - found.score:.0f} % of them; "
        f"oddest: {found.oddest} at the {found.percentiles[found.oddest]:.0f}th percentile"
    )
    return Finding(value=found.distance, note=note)


def plausibility_figures(measured: Measurements) -> dict[str, float] | None:
    """The figures of `FIGURES` by name; None for a map that is black or too small."""
    octaves = contrast_octaves(measured)
    if octaves is None:
        return None
    total = measured.total
    halves = np.asarray(luminance(energy_of_halves(measured.tiny)), np.float64)
    vector = np.linalg.norm(light_vector(measured.tiny))
    light = np.asarray(luminance(measured.tiny), np.float32)
    power = _power(light)
    median = float(np.median(measured.small_luminance)) or total / (4 * np.pi)
    share = top_share(measured.envmap) or 0.0
    figures = {
        "top-share": _odds(share),
        "peak-over-median": float(np.log2(float(measured.luminance.max())) - np.log2(median)),
        "contrast": octaves,
        "anisotropy": _odds(float(vector) / total),
        "upper-share": _odds(float(halves[0] / halves.sum())),
    }
    for name, (first, last) in _BANDS.items():
        part = float(power[first : last + 1].sum() / max(power[0], 1e-300))
        figures[name] = float(np.log2(max(part, _LEAST_POWER)))
    return figures


def place(figures: dict[str, float], reference: ReferenceSet) -> Placement:
    """Where a map with these figures lies among the reference maps of the nearest category."""
    own = np.array([figures[name] for name in reference.figures])
    placements = [
        _place_in(own, reference.figures, name, maps) for name, maps in reference.categories.items()
    ]
    return min(placements, key=lambda placement: placement.distance)


def deviations(values: NDArray[np.float64], maps: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far figures (..., F) are from the middle of maps (n, F), in robust deviations."""
    middle = np.median(maps, axis=0)
    spread = np.median(np.abs(maps - middle), axis=0) * _MAD_TO_SIGMA
    off = (values - middle) / np.maximum(spread, _LEAST_SPREAD)
    return np.clip(off, -_MOST_DEVIATIONS, _MOST_DEVIATIONS)


def _place_in(
    own: NDArray[np.float64], names: tuple[str, ...], category: str, maps: NDArray[np.float64]
) -> Placement:
    off = deviations(own, maps)
    distance = float(np.sqrt(np.mean(off**2)))
    distances = np.sqrt(np.mean(deviations(maps, maps) ** 2, axis=1))
    below = (maps < own).mean(axis=0) + 0.5 * (maps == own).mean(axis=0)
    return Placement(
        category=category,
        distance=distance,
        score=float(100 * (distances > distance).mean()),
        percentiles={name: float(100 * p) for name, p in zip(names, below, strict=True)},
        oddest=names[int(np.argmax(np.abs(off)))],
    )


def _power(light: NDArray[np.float32]) -> NDArray[np.float64]:
    """The power of luminance in each degree of spherical harmonics, (order + 1,)."""
    coefficients = project_harmonics(light[..., None], _ORDER)[:, 0]
    degrees = harmonics_degrees(_ORDER)
    return np.asarray(np.bincount(degrees, coefficients**2), np.float64)


def _odds(share: float) -> float:
    share = min(max(share, _LEAST_SHARE), 1 - _LEAST_SHARE)
    return float(np.log2(share / (1 - share)))

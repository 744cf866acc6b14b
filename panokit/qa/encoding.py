"""Whether values are linear: the contrast of a map, beside that of captured light.

A power of all values, as a display curve that was left in or taken out twice, multiplies every
distance on a scale of stops by the same factor, whatever the map shows. One such distance alone
varies a good deal from scene to scene; a weighted mean of several varies much less, because what
makes one of them large in a scene makes another small. The weights are those with the least
variance that a mean can have (the inverse of the covariance applied to ones).
"""

from collections.abc import Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.qa.measurements import SMALL_WIDTH_PX, Finding, Measurements, absent, stops_over

# Of the logarithms, found on the captured probes of the half that sets thresholds, by
# `tests/benchmarks/qa_damage_fit.py`. They add up to 1.
WEIGHTS: Mapping[str, float] = {
    "range": 0.43, "edges": -0.29, "color": 0.19, "peak": 0.24, "local": 0.43
}  # fmt: skip
# The mean of the weighted sum on those probes, in octaves.
TYPICAL = 1.791
# Twenty stops under the median there is nothing but noise.
_FLOOR_STOPS = -20.0
_BLUR_PX = 15
# A distance of less than this many stops is none.
_LEAST_STOPS = 1e-4
_BINS_PER_STOP = 100
# An even sky over a darker ground has little contrast of any other kind, as it is.
_EVEN_SKY_STOPS = 1.4


def contrast(measured: Measurements) -> Finding:
    """The contrast of a map over that of captured light: 1 is typical, 0.45 is a gamma of 2.2."""
    octaves = contrast_octaves(measured)
    if octaves is None:
        return absent(f"the map is black, or narrower than {SMALL_WIDTH_PX} pixels")
    if octaves < 0 and _sky_over_ground(measured) > _EVEN_SKY_STOPS:
        return absent("as low as under an even sky; whether a curve was left in does not show")
    return Finding(value=float(2**octaves))


def contrast_octaves(measured: Measurements) -> float | None:
    """The logarithm, to base 2, of `contrast`; None for a map that is black or too small."""
    if measured.small.shape[1] < SMALL_WIDTH_PX or measured.is_black:
        return None
    distances = contrast_distances(measured)
    return sum(weight * distances[name] for name, weight in WEIGHTS.items()) - TYPICAL


def contrast_distances(measured: Measurements) -> dict[str, float]:
    """The logarithms, to base 2, of distances in stops that any power of the values multiplies.

    `range` from the 5th to the 95th percentile of luminance over the sphere, `edges` the 90th
    percentile of steps between columns, `color` from the 10th to the 90th percentile of red
    over green, `peak` from the median to the maximum, `local` the deviation from the mean of
    15x15 pixels.
    """
    light = measured.small_luminance
    weights = measured.small_solid_angles
    median = float(np.median(light)) or float(light.mean()) or 1.0
    stops = stops_over(light, median, _FLOOR_STOPS)
    red, green = (stops_over(measured.small[..., c], median, _FLOOR_STOPS) for c in (0, 1))
    middle = slice(stops.shape[0] // 8, stops.shape[0] // 8 * 7)
    steps = np.abs(np.diff(stops[middle], axis=1, prepend=stops[middle, -1:]))
    local = stops - cv2.blur(stops, (_BLUR_PX, _BLUR_PX))
    distances = {
        "range": _spread(stops, weights, 0.05, 0.95),
        "edges": float(np.quantile(steps[:, ::2], 0.9)),
        "color": _spread(red - green, weights, 0.1, 0.9),
        "peak": float(stops.max()),
        "local": float(local.std()),
    }
    return {name: float(np.log2(max(d, _LEAST_STOPS))) for name, d in distances.items()}


def _sky_over_ground(measured: Measurements) -> float:
    """By how many stops the median of the upper half is over that of the lower one."""
    light = measured.small_luminance
    middle = light.shape[0] // 2
    tiny = float(np.finfo(np.float32).tiny)
    above, below = (max(float(np.median(part)), tiny) for part in (light[:middle], light[middle:]))
    return float(np.log2(above) - np.log2(below))


def _spread(
    values: NDArray[np.float32], weights: NDArray[np.float64], low: float, high: float
) -> float:
    """The distance between two percentiles over the sphere, by a histogram."""
    least = float(values.min())
    bins = np.minimum((values - least) * _BINS_PER_STOP, 1e5).astype(np.int64)
    reached = np.cumsum(np.bincount(bins.ravel(), weights.ravel()))
    first, last = np.searchsorted(reached, [low * reached[-1], high * reached[-1]])
    return float(last - first) / _BINS_PER_STOP

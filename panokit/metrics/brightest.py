"""Where a map is brightest, and whether that place means anything.

The 2018 thesis measures "the distance between the brightest pixels" of two 64x64 maps. Its text
leaves open whether it takes the brightest pixel of each channel or of the luminance, and whether
columns wrap, so all readings are here: a 25th percentile of 0.3 px, as it reports, is possible
only for the mean over R, G and B, and a maximum of 45 px only if both axes wrap (45.25) or by
chance (plain: 89.1, columns wrapped: 70.7). The distance in degrees is the one to quote.

On a map with no dominant light (an overcast sky, a room with two equal windows) the brightest
pixel is an accident. `dominance_ratio` tells such maps, so that they are reported apart.
"""

from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.errors import UsageError
from panokit.frames import angle_between
from panokit.metrics.pairs import Radiance, check_radiance, radiance_pair
from panokit.sphere.equirect import equirect_directions
from panokit.sphere.resample import resize_radiance
from panokit.sphere.solid_angle import pixel_solid_angles

Reading = Literal["luma", "rgb-mean"]
Wrap = Literal["none", "columns", "both"]

DOMINANT = 2.0
"""From this `dominance_ratio` on, a map counts as having one dominant light."""

_CAP_DEG = 15.0
_GRID_WIDTH_PX = 64


def brightest_px(
    estimate: Radiance, truth: Radiance, *, reading: Reading = "luma", wrap: Wrap = "columns"
) -> float:
    """The distance between the brightest pixels of two maps, in pixels of the maps.

    Of equally bright pixels the first in rows from the top counts, as `numpy.argmax` has it.

    Args:
        estimate: (H, W, 3), linear.
        truth: (H, W, 3), linear, of the same size.
        reading: "luma" takes the brightest luminance; "rgb-mean" takes the brightest pixel of
            each channel and averages the three distances.
        wrap: "none" measures on the flat picture; "columns" lets azimuth wrap, which is what
            the sphere does; "both" wraps rows too, which is wrong and only there to compare.

    Raises:
        UsageError: If a reading is not known, or the shapes differ.
        ImageError: If a map is not a spherical picture of finite radiance.
    """
    guess, true = radiance_pair(estimate, truth)
    if reading == "luma":
        pairs = [(luminance(guess), luminance(true))]
    elif reading == "rgb-mean":
        pairs = [(guess[..., channel], true[..., channel]) for channel in range(3)]
    else:
        raise UsageError(f"The reading is 'luma' or 'rgb-mean', not {reading!r}.")
    return float(np.mean([_distance_px(a, b, wrap) for a, b in pairs]))


def brightest_deg(estimate: Radiance, truth: Radiance) -> float:
    """The great-circle angle between the pixels of highest luminance, in degrees.

    A peak that is stable against noise and ties is `panokit.metrics.lighting.peak_error_deg`.
    """
    guess, true = radiance_pair(estimate, truth)
    height, width = true.shape[:2]
    directions = equirect_directions(width, height).reshape(-1, 3)
    a, b = (directions[int(luminance(radiance).argmax())] for radiance in (guess, true))
    return float(np.degrees(angle_between(a, b)))


def dominance_ratio(radiance: Radiance) -> float:
    """How many times more light comes from the brightest direction than from any other.

    The mean luminance in the brightest cap of 15 degrees radius, over that of the brightest
    cap that does not overlap it, at 64x32 pixels. 1 is a uniform sky or two equal lamps; a sun
    in a clear sky has tens. A black map has 1. No light needs to be found for it; the dominance
    of a light list (`panokit.sphere.lights`) compares the lights that were found.

    Args:
        radiance: (H, W, 3), linear; any scale.
    """
    check_radiance(np.asarray(radiance))
    small = np.asarray(radiance, np.float32)
    if small.shape[1] > _GRID_WIDTH_PX:
        small = resize_radiance(small, _GRID_WIDTH_PX)
    height, width = small.shape[:2]
    light = _cap_means(width, height) @ np.asarray(luminance(small), np.float64).ravel()
    primary = int(light.argmax())
    directions = equirect_directions(width, height).reshape(-1, 3)
    apart = directions @ directions[primary] < np.cos(np.deg2rad(2 * _CAP_DEG))
    secondary = float(light[apart].max())
    if light[primary] <= 0:
        return 1.0
    return float(light[primary]) / secondary if secondary > 0 else float("inf")


def has_dominant_light(radiance: Radiance, at_least: float = DOMINANT) -> bool:
    """Whether the direction of "the" light of this map means anything; see `dominance_ratio`."""
    return dominance_ratio(radiance) >= at_least


def _distance_px(a: NDArray[np.floating], b: NDArray[np.floating], wrap: Wrap) -> float:
    height, width = a.shape
    row_a, column_a = divmod(int(a.argmax()), width)
    row_b, column_b = divmod(int(b.argmax()), width)
    rows, columns = abs(row_a - row_b), abs(column_a - column_b)
    if wrap not in ("none", "columns", "both"):
        raise UsageError(f"What wraps is 'none', 'columns' or 'both', not {wrap!r}.")
    if wrap != "none":
        columns = min(columns, width - columns)
    if wrap == "both":
        rows = min(rows, height - rows)
    return float(np.hypot(rows, columns))


@lru_cache(maxsize=2)
def _cap_means(width_px: int, height_px: int) -> NDArray[np.float32]:
    """The matrix (N, N) that takes a map's pixels to the mean over the cap round each."""
    directions = equirect_directions(width_px, height_px).reshape(-1, 3)
    inside = directions @ directions.T >= np.cos(np.deg2rad(_CAP_DEG))
    weights = inside * pixel_solid_angles(height_px, width_px).reshape(-1).astype(np.float32)
    weights /= weights.sum(axis=1, keepdims=True)
    weights.setflags(write=False)
    return np.asarray(weights, np.float32)

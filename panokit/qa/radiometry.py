"""Figures about the amount and the spread of light in a map."""

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance, weighted_percentile
from panokit.envmap import EnvironmentMap
from panokit.sphere import energy, pixel_solid_angles, row_solid_angles

# A plateau of fewer pixels is a peak: a real sun covers about five in a 1024x512 map.
_LEAST_PLATEAU_PX = 5
_PLATEAU = 0.99
_TOP_SHARE = 1e-3
_LEDGER = "energy_after"


def unphysical_values(envmap: EnvironmentMap) -> float:
    """How many values are not finite or are negative."""
    radiance = envmap.radiance
    return float(np.count_nonzero(~(np.isfinite(radiance) & (radiance >= 0))))


def mean_radiance(envmap: EnvironmentMap) -> float:
    """The luminance of the map's energy, over the 4 pi of the sphere."""
    return float(luminance(energy(envmap.radiance))) / (4 * np.pi)


def ledger_error(envmap: EnvironmentMap) -> float | None:
    """By how much the energy differs from what the last stage that recorded it wrote down.

    A stage records the sum of radiance x solid angle, per channel, of the map it hands on as
    `energy_after` in the values of its step. The largest relative error of the channels counts.
    """
    newest_first = reversed(envmap.provenance.steps)
    recorded = next((s.values[_LEDGER] for s in newest_first if _LEDGER in s.values), None)
    if recorded is None:
        return None
    expected = np.asarray(recorded, np.float64)
    found = energy(envmap.radiance)
    if expected.shape != found.shape:
        return None
    scale = max(float(np.abs(expected).max()), 1e-30)
    return float(np.abs(found - expected).max() / scale)


def dynamic_range_stops(envmap: EnvironmentMap) -> float | None:
    """Stops from the median luminance over the sphere to the peak; None if the median is 0."""
    light = luminance(envmap.radiance)
    solid_angles = row_solid_angles(envmap.height_px)[:, None]
    median = weighted_percentile(light, solid_angles, 50)
    return float(np.log2(float(light.max()) / median)) if median > 0 else None


def top_share(envmap: EnvironmentMap) -> float | None:
    """The share of the energy that comes from the brightest 0.1 % of the sphere."""
    light = luminance(envmap.radiance).astype(np.float64).ravel()
    solid_angles = pixel_solid_angles(envmap.height_px).ravel()
    total = float(light @ solid_angles)
    if total <= 0:
        return None
    wanted = _TOP_SHARE * 4 * np.pi
    # Even the narrowest rows, at the poles, need no more than this many pixels.
    count = min(len(light), _pixels_that_cover(envmap.height_px, wanted))
    brightest = np.argpartition(light, len(light) - count)[-count:]
    order = brightest[np.argsort(-light[brightest], kind="stable")]
    covered = np.minimum(np.cumsum(solid_angles[order]), wanted)
    taken = np.diff(covered, prepend=0.0)
    return float(light[order] @ taken) / total


def clipped_area_percent(envmap: EnvironmentMap) -> float | None:
    """The share of the sphere, in percent, on a flat plateau at the map's maximum.

    Radiance that was cut off, by a camera or by a file format, lies at one level; a real
    source peaks.
    """
    brightest = envmap.radiance.max(axis=2)
    peak = float(brightest.max())
    if peak <= 0:
        return None
    plateau = brightest >= _PLATEAU * peak
    if np.count_nonzero(plateau) < _LEAST_PLATEAU_PX:
        return 0.0
    covered = plateau.sum(axis=1) @ row_solid_angles(envmap.height_px)
    return float(covered) / (4 * np.pi) * 100


def _pixels_that_cover(height_px: int, solid_angle: float) -> int:
    narrow_first: NDArray[np.float64] = np.sort(row_solid_angles(height_px))
    covered = np.cumsum(narrow_first) * 2 * height_px
    rows = int(np.searchsorted(covered, solid_angle)) + 1
    return rows * 2 * height_px

"""Figures about the amount and the spread of light in a map."""

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.envmap import EnvironmentMap
from panokit.qa.measurements import Finding, Measurements, absent
from panokit.sphere import energy, pixel_solid_angles, row_solid_angles

# A plateau of fewer pixels is a peak: a real sun covers about five in a 1024x512 map.
_LEAST_PLATEAU_PX = 5
_PLATEAU = 0.99
# A clipped source is as flat as this at its top, and this much of it above the half is flat.
_TOP, _HALF = 0.98, 0.5
_STEEP = 0.3
_LARGEST_SHARE = 1e-3
_WIDTH_PX = 1024
_TOP_SHARE = 1e-3
_LEDGER = "energy_after"


def physical(measured: Measurements) -> Finding:
    """How many values are not finite or are negative."""
    radiance = measured.radiance
    return Finding(value=float(np.count_nonzero(~(np.isfinite(radiance) & (radiance >= 0)))))


def brightness(measured: Measurements) -> Finding:
    """The luminance of the map's energy, over the 4 pi of the sphere."""
    return Finding(value=float(luminance(measured.energy)) / (4 * np.pi))


def ledger(measured: Measurements) -> Finding:
    """By how much the energy differs from what the last stage that recorded it wrote down.

    A stage records the sum of radiance x solid angle, per channel, of the map it hands on as
    `energy_after` in the values of its step. The largest relative error of the channels counts.
    """
    newest_first = reversed(measured.envmap.provenance.steps)
    recorded = next((s.values[_LEDGER] for s in newest_first if _LEDGER in s.values), None)
    if recorded is None:
        return absent("no stage recorded the energy")
    try:
        expected = np.asarray(recorded, np.float64)
    except (TypeError, ValueError):
        return absent("the recorded energy is no list of numbers")
    found = measured.energy
    if expected.shape != found.shape or not np.isfinite(expected).all():
        return absent("the recorded energy is not that of three channels")
    scale = max(float(np.abs(expected).max()), 1e-30)
    return Finding(value=float(np.abs(found - expected).max() / scale))


def dynamic_range(measured: Measurements) -> Finding:
    """Stops from the median luminance over the sphere to the peak."""
    if measured.is_black:
        return absent("the map is black")
    stops = dynamic_range_stops(measured.envmap)
    return (
        absent("more than half of the sphere is black") if stops is None else Finding(value=stops)
    )


def brightest_share(measured: Measurements) -> Finding:
    """The share of the energy that comes from the brightest 0.1 % of the sphere."""
    share = top_share(measured.envmap)
    return absent("the map is black") if share is None else Finding(value=share)


def clipped_area(measured: Measurements) -> Finding:
    """The share of the sphere, in percent, on a flat plateau at the map's maximum."""
    percent = clipped_area_percent(measured.envmap)
    return absent("the map is black") if percent is None else Finding(value=percent)


def clipped_source(measured: Measurements) -> Finding:
    """How many pixels of a small source are equally bright: a clipped sun has no peak.

    A real sun has one brightest pixel, or two, and its image falls off at once. Clipped, the
    pixels that were brighter lie at one level, in each channel, and little of it is between
    that level and half of it. In a large soft source many pixels are nearly equal too, but
    many more are between. What covers over 0.1 % of the sphere is no small source. Pixels
    count as those of a map 1024 wide.
    """
    if measured.is_black:
        return absent("the map is black")
    most = 0
    for channel in range(3):
        values = measured.radiance[..., channel]
        peak = float(values.max())
        if peak <= 0:
            continue
        above = values[values >= _HALF * peak]
        flat = int(np.count_nonzero(above >= _TOP * peak))
        if _STEEP * len(above) <= flat <= _LARGEST_SHARE * values.size:
            most = max(most, flat)
    if measured.width_px > _WIDTH_PX:
        return Finding(value=most * (_WIDTH_PX / measured.width_px) ** 2)
    return Finding(value=float(most))


def dynamic_range_stops(envmap: EnvironmentMap) -> float | None:
    """Stops from the median luminance over the sphere to the peak; None if the median is 0."""
    light = luminance(envmap.radiance)
    solid_angles = np.broadcast_to(row_solid_angles(envmap.height_px)[:, None], light.shape)
    median = _weighted_median(light.ravel(), solid_angles.ravel())
    # A difference of logarithms, where a quotient would overflow at the ends of float32.
    return float(np.log2(float(light.max())) - np.log2(median)) if median > 0 else None


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
    # Twice as fast as a maximum along the short last axis.
    red, green, blue = (envmap.radiance[..., channel] for channel in range(3))
    brightest = np.maximum(np.maximum(red, green), blue)
    peak = float(brightest.max())
    if peak <= 0:
        return None
    plateau = brightest >= _PLATEAU * peak
    if np.count_nonzero(plateau) < _LEAST_PLATEAU_PX:
        return 0.0
    covered = plateau.sum(axis=1) @ row_solid_angles(envmap.height_px)
    return float(covered) / (4 * np.pi) * 100


def mean_radiance(envmap: EnvironmentMap) -> float:
    """The luminance of the map's energy, over the 4 pi of the sphere."""
    return float(luminance(energy(envmap.radiance))) / (4 * np.pi)


def _weighted_median(values: NDArray[np.floating], weights: NDArray[np.floating]) -> float:
    """The value below which half of the weight lies; it sorts only those near it."""
    half = float(weights.sum(dtype=np.float64)) / 2
    # Between two order statistics that surely lie on either side of it.
    low, high = np.quantile(values[:: max(len(values) // 4096, 1)], [0.3, 0.7])
    below = values < low
    near = (values <= high) & ~below
    already = float(weights[below].sum(dtype=np.float64))
    chosen, chosen_weights = values[near], weights[near]
    if not already < half <= already + float(chosen_weights.sum(dtype=np.float64)):
        already, chosen, chosen_weights = 0.0, values, weights
    order = np.argsort(chosen)
    reached = already + np.cumsum(chosen_weights[order], dtype=np.float64)
    return float(chosen[order[min(int(np.searchsorted(reached, half)), len(order) - 1)]])


def _pixels_that_cover(height_px: int, solid_angle: float) -> int:
    narrow_first: NDArray[np.float64] = np.sort(row_solid_angles(height_px))
    covered = np.cumsum(narrow_first) * 2 * height_px
    rows = int(np.searchsorted(covered, solid_angle)) + 1
    return rows * 2 * height_px

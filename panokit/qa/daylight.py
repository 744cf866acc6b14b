"""Figures about what is up and what is blue: light comes from above, and skies are not brown.

Both hold indoors and at night as well, only less so; the limits leave room for that.
"""

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.color.temperature import color_temperature
from panokit.qa.measurements import Finding, Measurements, absent, stops_over
from panokit.sphere import energy

# Nearer to the horizon than this, houses and hills are neither sky nor ground.
_CLEAR_OF_HORIZON_DEG = 12.0
_OVERHEAD_DEG = 50.0
# How much a sky that is bluer than the ground says about what is up, beside where light is from.
_COLOR_WEIGHT = 0.65
# A smooth sky: the median step between neighbors, in stops, is smaller than this.
_SMOOTH_STOPS = 2.0**-3
_SKY_TO_SUN_WEIGHT = 0.5
# Leaves: greener than red and than blue by so many octaves, over so much of the picture without
# its poles. They are yellowish, never bluish; the weight brings them to the measure of skies.
_GREENER, _LEAST_GREEN_SHARE, _LEAVES_WEIGHT = 0.15, 0.08, 1.5
# Daylight: the upper half is brighter than the lower one by so many stops, or holds a sun, a
# light so small that gives such a share of all.
_SKY_OVER_GROUND_STOPS = 0.5
_SUN_RADIUS, _SUN_SHARE = np.deg2rad(1.5), 0.15
_FLOOR_STOPS = -8.0
_LEAST_HEIGHT_PX = 32


def uprightness(measured: Measurements) -> Finding:
    """How much more light comes from above than from below, in octaves, with a say for color.

    The logarithm of the energy above the horizon over that below, plus a part of that by which
    the upper half is bluer. Below zero, the map stands on its head.
    """
    if measured.is_black or measured.tiny.shape[0] < _LEAST_HEIGHT_PX:
        return absent("the map is black or too small")
    light = np.asarray(luminance(energy_of_halves(measured.tiny)), np.float64)
    share = np.log2(max(light[0], 1e-30) / max(light[1], 1e-30))
    return Finding(value=float(share + _COLOR_WEIGHT * _blueness(measured).above_ground))


def channel_order(measured: Measurements) -> Finding:
    """By how many octaves, in blue over red, what is above is bluer than what is below.

    Where the upper half is a smooth sky, its zenith beside the light as a whole counts too: a
    sky is bluer than its sun. So do leaves, which are redder than they are blue. The smallest
    is the figure; far below zero, red and blue have changed places. Under a ceiling anything
    goes: without a bright upper half or a sun, nothing is said.
    """
    if measured.is_black or measured.tiny.shape[0] < _LEAST_HEIGHT_PX:
        return absent("the map is black or too small")
    found = _blueness(measured)
    if found.sky_over_ground < _SKY_OVER_GROUND_STOPS and not _has_sun(measured):
        return absent("what is above is neither brighter than the ground nor holds a sun")
    value = found.above_ground
    if found.smooth:
        value = min(value, _SKY_TO_SUN_WEIGHT * found.sky_to_light)
    if found.leaves is not None:
        value = min(value, -_LEAVES_WEIGHT * found.leaves)
    return Finding(value=value)


def light_temperature(measured: Measurements) -> Finding:
    """The correlated color temperature of the map's light as a whole, in kelvin."""
    if measured.is_black:
        return absent("the map is black")
    found = color_temperature(measured.energy)
    if found is None:
        return absent("no black body has this color")
    return Finding(value=found.kelvin, note=f"Duv {found.duv:+.3f}")


def sky_temperature(measured: Measurements) -> Finding:
    """The correlated color temperature, in kelvin, of a smooth sky overhead."""
    if measured.is_black or measured.tiny.shape[0] < _LEAST_HEIGHT_PX:
        return absent("the map is black or too small")
    if not _blueness(measured).smooth:
        return absent("what is overhead is no smooth sky")
    rows = _elevations_deg(measured.tiny.shape[0]) > _OVERHEAD_DEG
    overhead = np.median(measured.tiny[rows].reshape(-1, 3), axis=0).astype(np.float64)
    found = color_temperature(overhead)
    return absent("bluer than any black body") if found is None else Finding(value=found.kelvin)


def energy_of_halves(radiance: NDArray[np.float32]) -> NDArray[np.float64]:
    """The energy from above and from below the horizon, (2, 3)."""
    upper = np.where(
        (np.arange(radiance.shape[0]) < radiance.shape[0] // 2)[:, None, None],
        radiance,
        np.float32(0),
    )
    above = energy(upper)
    return np.stack([above, np.maximum(energy(radiance) - above, 0.0)])


class _Blueness:
    """Blue over red, in octaves, and whether what is above is smooth as a sky."""

    def __init__(self, tiny: NDArray[np.float32]) -> None:
        light = np.asarray(luminance(tiny), np.float32)
        median = float(np.median(light)) or float(light.mean()) or 1.0
        red, green, blue = (stops_over(tiny[..., c], median, _FLOOR_STOPS) for c in range(3))
        blue_to_red = blue - red
        elevations = _elevations_deg(tiny.shape[0])
        above = blue_to_red[elevations > _CLEAR_OF_HORIZON_DEG]
        below = blue_to_red[elevations < -_CLEAR_OF_HORIZON_DEG]
        self.above_ground = float(np.median(above) - np.median(below))
        cut = tiny.shape[0] // 8
        leafy = (green - np.maximum(red, blue) > _GREENER)[cut:-cut]
        enough = float(leafy.mean()) > _LEAST_GREEN_SHARE
        self.leaves = float(np.median(blue_to_red[cut:-cut][leafy])) if enough else None
        whole = energy(tiny)
        overhead = float(np.median(blue_to_red[elevations > _OVERHEAD_DEG]))
        self.sky_to_light = overhead - float(np.log2(max(whole[2], 1e-30) / max(whole[0], 1e-30)))
        stops = stops_over(light, median, _FLOOR_STOPS)
        steps = np.abs(stops - np.roll(stops, 1, axis=1)) + np.abs(np.gradient(stops, axis=0))
        above_median, below_median = (
            float(np.median(stops[part]))
            for part in (
                elevations > _CLEAR_OF_HORIZON_DEG,
                elevations < -_CLEAR_OF_HORIZON_DEG,
            )
        )
        self.sky_over_ground = above_median - below_median
        self.smooth = float(np.median(steps[elevations > _CLEAR_OF_HORIZON_DEG])) < _SMOOTH_STOPS


def _has_sun(measured: Measurements) -> bool:
    return any(
        light.angular_radius < _SUN_RADIUS
        and light.direction[1] > 0
        and light.luminance > _SUN_SHARE * measured.total
        for light in measured.lights.lights
    )


def _blueness(measured: Measurements) -> _Blueness:
    return _Blueness(measured.tiny)


def _elevations_deg(height_px: int) -> NDArray[np.float64]:
    return 90 - (np.arange(height_px) + 0.5) / height_px * 180

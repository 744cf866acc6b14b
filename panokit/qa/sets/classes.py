"""What kind of light a map shows, told from its light alone.

The rules were found on captured maps of Poly Haven; docs/ideas/qa-sets.md has how often they
are right there. Radiance is relative, so that a moonlit road is a sunlit one, and a clear night
without lamps is an overcast day.
"""

from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from panokit.qa.sets.measured import Measured, color_balance

_SKY_DEG = 45.0
_GROUND_DEG = -30.0
# Stops of red over blue: a sky is at least a little blue, and bluer than the ground below it.
_BLUE_SKY = -0.1
_BLUER_THAN_GROUND = -0.25
# Mean and median steps between neighboring pixels overhead, in stops: a bare sky, and leaves.
_SMOOTH_SKY = 0.08
_LEAVES = 0.25
_HARD_RADIUS_DEG = 1.5
_LEAST_KEY_STOPS = -3.0
_MANY_LAMPS = 3


class LightClass(StrEnum):
    """The kinds."""

    SUN = "sun"
    OVERCAST = "overcast"
    NIGHT = "night"
    INDOOR = "indoor"


MEANINGS: dict[LightClass, str] = {
    LightClass.SUN: "open sky with one small hard light, the sun or the moon",
    LightClass.OVERCAST: "open sky without a hard light: clouds, dusk, a night without lamps",
    LightClass.NIGHT: "open sky with several small hard lights: lamps",
    LightClass.INDOOR: "no open sky overhead",
}


def light_class(measured: Measured) -> LightClass:
    """The kind of light of a map."""
    if not _is_outdoor(measured):
        return LightClass.INDOOR
    lights = measured.lights.lights
    hard = [light for light in lights if np.degrees(light.angular_radius) < _HARD_RADIUS_DEG]
    if not hard or hard[0] is not lights[0]:
        return LightClass.OVERCAST
    if len(lights) >= _MANY_LAMPS:
        return LightClass.NIGHT
    key = measured.lights.key_to_fill
    return LightClass.SUN if key > 2**_LEAST_KEY_STOPS else LightClass.OVERCAST


def _is_outdoor(measured: Measured) -> bool:
    height = measured.envmap.height_px
    elevation = 90 - (np.arange(height) + 0.5) / height * 180
    overhead, below = elevation >= _SKY_DEG, elevation < _GROUND_DEG
    stops = measured.stops[overhead]
    steps = np.abs(stops - np.roll(stops, 1, axis=1))
    if np.median(steps) >= _LEAVES:
        return True
    sky, ground = (_typical_balance(measured.envmap.radiance[rows]) for rows in (overhead, below))
    bluer = sky - ground < _BLUER_THAN_GROUND
    return bool(sky < _BLUE_SKY and (bluer or steps.mean() < _SMOOTH_SKY))


def _typical_balance(colors: NDArray[np.float32]) -> float:
    return float(color_balance(np.median(colors.reshape(-1, 3), axis=0), "red"))

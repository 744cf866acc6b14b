"""A map at the size at which all maps are measured, with its lights and harmonics.

Every map is averaged to one width first, since a sun is the brighter the finer the pixels are.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance, weighted_percentile
from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError
from panokit.sphere import (
    LightList,
    find_lights,
    harmonics_degrees,
    project_harmonics,
    resize,
    row_solid_angles,
)

WIDTH_PX = 512
ORDER = 16
# What is darker than the median by more stops than this is as good as black.
_DARKEST_STOPS = 14.0
_LEAST_COLOR = 1e-4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """A map with what several descriptors need of it.

    Attributes:
        envmap: `WIDTH_PX` wide, or less if it was narrower.
        stops: (H, W) float32, the log2 of luminance over its median.
        weights: (H, 1) float64, the solid angle of a pixel over that of the sphere.
        lights: Its sources.
        power: (ORDER + 1,) float64, the power of its luminance in each degree of harmonics.
    """

    envmap: EnvironmentMap
    stops: NDArray[np.float32]
    weights: NDArray[np.float64]
    lights: LightList
    power: NDArray[np.float64]

    def percentile(self, percent: float) -> float:
        """A percentile of `stops` over the sphere."""
        return weighted_percentile(self.stops, self.weights, percent)


def measure(envmap: EnvironmentMap) -> Measured:
    """Bring a map to the common size and find its lights and harmonics.

    Raises:
        ItemError: If the map is black, or too small for harmonics of order 16.
    """
    if envmap.height_px <= 2 * ORDER:
        raise ItemError(
            f"A map of {envmap.width_px}x{envmap.height_px} is too small to describe. "
            f"Give maps of more than {4 * ORDER}x{2 * ORDER}.",
            reason="too-small",
        )
    small = resize(envmap, WIDTH_PX) if envmap.width_px > WIDTH_PX else envmap
    light = luminance(small.radiance)
    weights = row_solid_angles(small.height_px)[:, None] / (4 * np.pi)
    return Measured(
        envmap=small,
        stops=_stops(light, weights),
        weights=weights,
        lights=find_lights(small.radiance),
        power=_power(light),
    )


def color_balance(colors: NDArray[np.floating], toward: str) -> NDArray[np.float64]:
    """How red or green colors are, whatever their brightness.

    Args:
        colors: (..., 3), linear RGB.
        toward: "red" for stops of red over blue, "green" for stops of green over magenta.
    """
    colors = np.asarray(colors, np.float64)
    floor = np.maximum(_LEAST_COLOR * colors.sum(axis=-1, keepdims=True), 1e-30)
    red, green, blue = np.moveaxis(np.log2(np.maximum(colors, floor)), -1, 0)
    return np.asarray(red - blue if toward == "red" else green - (red + blue) / 2)


def _stops(light: NDArray[np.floating], weights: NDArray[np.float64]) -> NDArray[np.float32]:
    middle = weighted_percentile(light, weights, 50)
    if middle <= 0:
        # Lamps in a dark room: what is lit at all gives the scale.
        middle = float(light.max()) * 2.0**-_DARKEST_STOPS
    if middle <= 0:
        raise ItemError("The map is black, so there is no light to describe.", reason="black-map")
    floor = middle * 2.0**-_DARKEST_STOPS
    return np.asarray(np.log2(np.maximum(light, floor) / middle), np.float32)


def _power(light: NDArray[np.floating]) -> NDArray[np.float64]:
    coefficients = project_harmonics(light[..., None], ORDER)[:, 0]
    return np.asarray(np.bincount(harmonics_degrees(ORDER), coefficients**2), np.float64)

"""What several checks need of a map, worked out once: luminance, a small copy, lights.

A check takes a `Measurements` and returns a `Finding`. What is costly and wanted by more than one
check is a property here, computed when first asked for.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture
from panokit.color.luminance import luminance
from panokit.envmap import EnvironmentMap
from panokit.provenance import Step
from panokit.qa.reference_set import ReferenceSet
from panokit.sphere import (
    LightList,
    energy,
    find_lights,
    pixel_solid_angles,
    resize_radiance,
    row_solid_angles,
)

# Lights, colors and contrast are measured at this width: a sun is still a pixel wide, and a map
# gives the same figures whatever its own width.
SMALL_WIDTH_PX = 512
# Darker than this under the median is noise.
_FLOOR_STOPS = -8.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One figure of one check.

    Attributes:
        value: The figure, or None where it cannot be had.
        note: Why it cannot be had, or what it points to; "" if there is nothing to say.
    """

    value: float | None
    note: str = ""


def absent(why: str) -> Finding:
    """A check that does not apply, and why."""
    return Finding(value=None, note=why)


def stops_over(light: NDArray[np.float32], level: float, floor_stops: float) -> NDArray[np.float32]:
    """Light in stops over a positive level, not below a floor; the same at any scale.

    The level is taken off in two parts, its power of two first, which is exact: a plain
    quotient would overflow, and a difference of logarithms round, at the ends of float32.
    """
    fraction, exponent = np.frexp(level)
    scaled = np.ldexp(light, -int(exponent)) * np.float32(1 / fraction)
    return np.asarray(np.log2(np.maximum(scaled, np.float32(2.0**floor_stops))), np.float32)


class Measurements:
    """A map with what the checks share.

    Args:
        envmap: The map.
        capture: Where it is from; None for what the map itself says.
        reference: The maps to place it among; None for those that ship.
    """

    def __init__(
        self,
        envmap: EnvironmentMap,
        capture: Capture | None = None,
        reference: ReferenceSet | None = None,
    ) -> None:
        self.envmap = envmap
        self.capture = capture or envmap.capture
        self.reference = reference

    @property
    def radiance(self) -> NDArray[np.float32]:
        """(H, W, 3), as it is in the file."""
        return self.envmap.radiance

    @property
    def width_px(self) -> int:
        """Of the map."""
        return self.envmap.width_px

    @cached_property
    def luminance(self) -> NDArray[np.float32]:
        """(H, W)."""
        return np.asarray(luminance(self.radiance), np.float32)

    @cached_property
    def energy(self) -> NDArray[np.float64]:
        """(3,): the sum of radiance x solid angle."""
        return energy(self.radiance)

    @cached_property
    def is_black(self) -> bool:
        """Whether there is no light at all."""
        return not float(luminance(self.energy)) > 0

    @cached_property
    def median(self) -> float:
        """Of the luminance of the pixels; where that is 0 their mean, and 1 for a black map."""
        median = float(np.median(self.luminance))
        return median or float(self.luminance.mean(dtype=np.float64)) or 1.0

    @cached_property
    def stops(self) -> NDArray[np.float32]:
        """(H, W): luminance in stops over the median, not below -8."""
        return stops_over(self.luminance, self.median, _FLOOR_STOPS)

    @cached_property
    def small(self) -> NDArray[np.float32]:
        """(h, w, 3): the map, not wider than 512, with the same energy."""
        return resize_radiance(self.radiance, min(SMALL_WIDTH_PX, self.width_px))

    @cached_property
    def small_luminance(self) -> NDArray[np.float32]:
        """(h, w), of `small`."""
        return np.asarray(luminance(self.small), np.float32)

    @cached_property
    def small_solid_angles(self) -> NDArray[np.float64]:
        """(h, w): the solid angle of each pixel of `small`."""
        return pixel_solid_angles(self.small.shape[0])

    @cached_property
    def tiny(self) -> NDArray[np.float32]:
        """(h, w, 3): the map, not wider than 256: what shows without any detail."""
        return resize_radiance(self.small, min(SMALL_WIDTH_PX // 2, self.width_px))

    @cached_property
    def lights(self) -> LightList:
        """The lights of `small`."""
        return find_lights(self.small)

    @cached_property
    def total(self) -> float:
        """The luminance of the energy of `small`, which is that of the map."""
        rows = row_solid_angles(self.small.shape[0])
        return float(self.small_luminance.sum(axis=1, dtype=np.float64) @ rows)

    def step(self, stage: str) -> Step | None:
        """What the last step of a stage wrote down, or None."""
        return self.envmap.provenance.last(stage)

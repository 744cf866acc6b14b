"""The sun of a map as a light of its own, for tools that have such lights.

A renderer finds a sun of a few pixels by luck, and file formats of small range cut it off; as
an analytic light it is sharp and free of noise. The light must then leave the map, or it would
shine twice: what is taken out and what is left add up to the map's energy.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.equirectangular import read_only
from panokit.errors import RecordError
from panokit.frames import angle_between
from panokit.sphere import equirect_directions, find_lights, row_solid_angles
from panokit.sun import SUN_RADIUS

_NEAR_DEG = 10.0
# The sky next to the sun is measured this many pixels round it.
_RING_PX = 2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AnalyticSun:
    """A distant light in the shape of a small disk.

    Attributes:
        direction: (3,) float64, unit, toward it, in the map's frame.
        irradiance: (3,) float64, RGB that it gives a surface which faces it, in the map's unit
            of radiance times steradian.
        angular_radius: In radians.
    """

    direction: NDArray[np.float64]
    irradiance: NDArray[np.float64]
    angular_radius: float = SUN_RADIUS

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "direction": [round(float(value), 7) for value in self.direction],
            "irradiance_rgb": [float(f"{float(value):.7g}") for value in self.irradiance],
            "angular_radius_deg": round(float(np.degrees(self.angular_radius)), 4),
        }


def sun_from_record(record: Mapping[str, Any]) -> AnalyticSun:
    """The sun that a record describes with direction, irradiance_rgb and angular_radius_deg.

    Raises:
        RecordError: If it does not.
    """
    try:
        direction = np.asarray(record["direction"], np.float64).reshape(3)
        return AnalyticSun(
            direction=read_only(direction / np.linalg.norm(direction)),
            irradiance=read_only(np.asarray(record["irradiance_rgb"], np.float64).reshape(3)),
            angular_radius=float(np.radians(record["angular_radius_deg"])),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise RecordError(
            f"This is no record of a sun ({error!r}). Make the map again.", reason="bad-sun"
        ) from error


def take_out_sun(
    radiance: NDArray[np.float32], sun: AnalyticSun
) -> tuple[NDArray[np.float32], AnalyticSun] | None:
    """The map without its sun, and the sun with exactly the energy that was taken out.

    The light within 10 degrees of where the sun is said to be is brought down to the level of
    the sky round it.

    Args:
        radiance: (H, W, 3), linear.
        sun: Where it is; its radius is kept.

    Returns:
        The rest (H, W, 3) and the sun, or None where the map has no light there.
    """
    lights = find_lights(radiance)
    apart = [float(angle_between(light.direction, sun.direction)) for light in lights.lights]
    if not apart or min(apart) > np.deg2rad(_NEAR_DEG):
        return None
    found = (lights.regions == int(np.argmin(apart)) + 1).astype(np.uint8)
    height, width = radiance.shape[:2]
    region = cv2.resize(found, (width, height), interpolation=cv2.INTER_NEAREST).astype(bool)
    ring = _widened(region, _RING_PX) & ~region
    level = np.median(radiance[ring], axis=0)
    removed = np.where(region[..., None], np.maximum(radiance - level, 0), 0).astype(np.float32)
    parcels = removed.astype(np.float64) * row_solid_angles(height, width)[:, None, None]
    energy = parcels.sum(axis=(0, 1))
    if not energy.any():
        return None
    middle = np.tensordot(luminance(parcels), equirect_directions(width, height), axes=2)
    taken = AnalyticSun(
        direction=read_only(np.asarray(middle / np.linalg.norm(middle), np.float64)),
        irradiance=read_only(np.asarray(energy, np.float64)),
        angular_radius=sun.angular_radius,
    )
    return np.asarray(radiance - removed, np.float32), taken


def _widened(mask: NDArray[np.bool_], reach_px: int) -> NDArray[np.bool_]:
    """The mask and what lies within some pixels of it, across the seam."""
    wrapped = np.pad(mask.astype(np.uint8), ((0, 0), (reach_px, reach_px)), mode="wrap")
    kernel = np.ones((2 * reach_px + 1, 2 * reach_px + 1), np.uint8)
    return np.asarray(cv2.dilate(wrapped, kernel)[:, reach_px:-reach_px] > 0)

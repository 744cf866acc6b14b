"""The lights of a map as blobs: where each is, how large, how strong, of what color.

The method is that of EnvMapNet (Somanath and Kurz 2021, "HDR Environment Map Estimation for
Real-Time Augmented Reality", after Gardner et al. 2019): take the peak and the connected region
down to 0.3 of it, again and again, until four fifths of the energy are explained; what the
published code does wrong is put right here (`panokit.metrics.envmapnet` keeps it as it is):

- luminance is the sum of the weighted channels, not the last term of it;
- regions go on across the seam and the poles;
- a peak is a peak of radiance, not of radiance times sin(theta), which moves every light toward
  the horizon and hides those at the zenith; energies count exact solid angles;
- what is not a light is told by how it spreads over the sphere, not by its width in pixels,
  which calls any lamp at a pole a band;
- a blob's place is its center of light, not that of an ellipse round its outline;
- blobs come strongest first.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.metrics.pairs import Radiance, check_radiance
from panokit.sphere.equirect import equirect_directions
from panokit.sphere.extension import pad_sphere
from panokit.sphere.resample import resize_radiance
from panokit.sphere.solid_angle import pixel_solid_angles
from panokit.sphere.sources import label_regions

WIDTH_PX = 256
"""Larger maps are averaged to this width first, so that the result depends on size little."""

_REGION_OVER_PEAK = 0.3
_ENERGY_LEFT = 0.2
_SPHERE_LEFT = 0.1
_MOST_PEAKS = 15
# The mean direction of a region, not normalized, is this long for a hemisphere, and shorter for
# a ring: wider is ambient light, not a light.
_LEAST_CONCENTRATION = 0.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LightBlob:
    """One light of a map.

    Attributes:
        direction: (3,) float64, unit length, toward the center of its light.
        solid_angle_sr: What its region covers.
        energy: (3,) float64, RGB: the sum of radiance times solid angle over the region.
    """

    direction: NDArray[np.float64]
    solid_angle_sr: float
    energy: NDArray[np.float64]

    @property
    def strength(self) -> float:
        """Luminance energy."""
        return float(luminance(self.energy))


def find_light_blobs(radiance: Radiance) -> tuple[LightBlob, ...]:
    """The lights of a map, strongest first; empty if its light is everywhere.

    Args:
        radiance: (H, W, 3), linear; the scale does not matter.

    Raises:
        ImageError: If it is not a spherical picture of finite radiance.
    """
    check_radiance(np.asarray(radiance))
    pixels = np.asarray(radiance, np.float32)
    if pixels.shape[1] > WIDTH_PX:
        pixels = resize_radiance(pixels, WIDTH_PX)
    height, width = pixels.shape[:2]
    solid_angles = pixel_solid_angles(height, width)
    lit = _merged(_peaks(_smoothed(luminance(pixels)), solid_angles))
    blobs = [_blob(pixels[region], region, solid_angles[region]) for region in lit]
    found = [blob for blob in blobs if blob is not None]
    return tuple(sorted(found, key=lambda blob: -blob.strength))


def _smoothed(light: NDArray[np.floating]) -> NDArray[np.float64]:
    """The published blur: a Gaussian of 1 % of the height, odd; none below 200 rows."""
    size = int(light.shape[0] * 0.01 / 2) * 2 + 1
    padded = pad_sphere(np.ascontiguousarray(light, np.float64), size)
    blurred = cv2.GaussianBlur(padded, (size, size), 0)[size:-size, size:-size]
    return np.asarray(blurred, np.float64)


def _peaks(light: NDArray[np.float64], solid_angles: NDArray[np.float64]) -> NDArray[np.bool_]:
    """All pixels of peaks that are compact enough to be lights, (H, W) bool."""
    free = np.ones(light.shape, bool)
    lights = np.zeros(light.shape, bool)
    whole = float((light * solid_angles).sum())
    for _ in range(_MOST_PEAKS):
        rest = np.where(free, light, 0)
        peak = int(rest.argmax())
        if rest.flat[peak] <= 0:
            break
        labels, _ = label_regions(rest >= _REGION_OVER_PEAK * rest.flat[peak])
        region = labels == labels.flat[peak]
        free &= ~region
        if _concentration(region, solid_angles) >= _LEAST_CONCENTRATION:
            lights |= region
        left = float((light * solid_angles)[free].sum())
        if left < _ENERGY_LEFT * whole or solid_angles[free].sum() < _SPHERE_LEFT * 4 * np.pi:
            break
    return lights


def _concentration(region: NDArray[np.bool_], solid_angles: NDArray[np.float64]) -> float:
    height, width = region.shape
    weights = solid_angles[region]
    mean = weights @ equirect_directions(width, height)[region] / weights.sum()
    return float(np.linalg.norm(mean))


def _merged(lights: NDArray[np.bool_]) -> list[NDArray[np.bool_]]:
    """Regions that touch or nearly touch, as one each: a lamp and its halo are peeled apart."""
    grown = cv2.dilate(pad_sphere(lights.astype(np.uint8)), np.ones((3, 3), np.uint8))
    labels, count = label_regions(grown[1:-1, 1:-1] > 0)
    return [(labels == number) & lights for number in range(1, count + 1)]


def _blob(
    colors: NDArray[np.float32], region: NDArray[np.bool_], weights: NDArray[np.float64]
) -> LightBlob | None:
    height, width = region.shape
    light = luminance(colors) * weights
    mean = light @ equirect_directions(width, height)[region]
    length = float(np.linalg.norm(mean))
    if length <= 0:
        return None
    return LightBlob(
        direction=np.asarray(mean / length, np.float64),
        solid_angle_sr=float(weights.sum()),
        energy=np.asarray(weights @ colors, np.float64),
    )

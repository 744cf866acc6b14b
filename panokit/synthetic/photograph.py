"""A street camera's picture of the radiance it stands in: exposure, glare, noise, sRGB."""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance, srgb_encode_u8, weighted_percentile
from panokit.sphere import resize_radiance, row_solid_angles

Picture = NDArray[np.floating[Any]]

# What the lens scatters: (share of the light, width in degrees). Real lenses scatter several
# percent; the tails beyond a few degrees are left to the renderer's own sky.
_GLARE = ((0.0035, 0.5), (0.0012, 2.5))
_GLARE_WIDTH_PX = 1024
_READ_NOISE = 0.0016
_SHOT_NOISE = 0.0022


@dataclass(frozen=True, slots=True, kw_only=True)
class Exposure:
    """How a picture is exposed.

    Attributes:
        scale: Radiance times this is in units of the level at which the picture clips.
    """

    scale: float


def metered_exposure(radiance: Picture, *, night: bool, stops: float = 0.0) -> Exposure:
    """The exposure that a camera's meter would choose for what lies around the horizon.

    Args:
        radiance: (H, W, 3), of any size.
        night: Dark scenes are left darker than day, as cameras do.
        stops: Compensation; +1 doubles the exposure.
    """
    height = radiance.shape[0]
    band = luminance(radiance[height // 4 : height * 5 // 8]).astype(np.float64)
    middle = float(np.exp(np.mean(np.log(band + 1e-4 * band.mean() + 1e-12))))
    scale = (0.10 if night else 0.17) / middle
    if not night:
        # Skies may clip in part, not altogether.
        bright = weighted_percentile(luminance(radiance), row_solid_angles(height)[:, None], 85.0)
        scale = min(scale, 0.92 / bright)
    return Exposure(scale=scale * 2.0**stops)


def photograph(radiance: Picture, exposure: Exposure, seed: int) -> NDArray[np.uint8]:
    """The picture, (H, W, 3) uint8 sRGB, of radiance (H, W, 3) in the camera's frame."""
    exposed = radiance * np.float32(exposure.scale)
    exposed += _glare(exposed)
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal(exposed.shape, np.float32)
    noise *= np.sqrt(_READ_NOISE**2 + _SHOT_NOISE**2 * np.clip(exposed, 0, 1))
    return srgb_encode_u8(exposed + noise)


def _glare(exposed: Picture) -> Picture:
    """The halo around what is brighter than the picture can show."""
    height, width = exposed.shape[:2]
    small = resize_radiance(exposed, _GLARE_WIDTH_PX) if width > _GLARE_WIDTH_PX else exposed
    excess = np.maximum(small - 1, 0)
    halo = np.zeros_like(excess)
    pad = small.shape[1] // 8
    padded = np.pad(excess, ((0, 0), (pad, pad), (0, 0)), mode="wrap")
    for share, width_deg in _GLARE:
        sigma = width_deg / 360 * small.shape[1]
        halo += np.float32(share) * cv2.GaussianBlur(padded, (0, 0), sigma)[:, pad:-pad]
    return np.asarray(cv2.resize(halo, (width, height), interpolation=cv2.INTER_LINEAR))

"""A light map or a photograph of the whole sphere, packed for the viewer in the page."""

import base64
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.transfer import srgb_decode_u8
from panokit.equirectangular import check_equirectangular
from panokit.errors import UsageError
from panokit.io import encode_jpeg
from panokit.report.bfloat import encode_radiance
from panokit.report.pictures import median_luminance
from panokit.sphere import blur_radiance, irradiance_map, resize_radiance

# What a page may weigh in all, and what its maps and photographs may of it.
BUDGET_BYTES = 48_000_000
LARGEST_WIDTH_PX = 768
_SMALLEST_WIDTH_PX = 128
# Measured on captured light probes, with base64.
_RADIANCE_BYTES_PER_PX = 2.6
_PHOTO_BYTES_PER_PX = 0.45
# A photograph is this much wider than a map: it costs so much less.
_PHOTO_WIDENING = 1.5
_WIDTH_STEP_PX = 16
DIFFUSE_WIDTH_PX = 48
_GLOSSY_SOURCE_WIDTH_PX = 96
GLOSSY_WIDTH_PX = 64
# A lobe that falls to a half at 12 degrees, as the glossy ball of `panokit.metrics`.
GLOSSY_KAPPA = 32.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """One map of the sphere in the page.

    Attributes:
        label: What it is.
        width_px: Of the map.
        height_px: Of the map.
        photo: Whether `data` is a JPEG, with 1.0 at its white, not radiance.
        data: Base64: a JPEG, or what `bfloat` wrote.
        diffuse: What white balls reflect, (24, 48, 3) as `bfloat` wrote it.
        glossy: What rough metal balls reflect, (32, 64, 3) as `bfloat` wrote it.
        gain: What its radiance is multiplied by to stand beside the first layer.
        median: The median of its luminance, before the gain.
    """

    label: str
    width_px: int
    height_px: int
    photo: bool
    data: str
    diffuse: str
    glossy: str
    gain: float = 1.0
    median: float = 0.0


def layer_width_px(radiance: int, photos: int = 0, *, budget_bytes: int = BUDGET_BYTES) -> int:
    """How wide each map may be for a page of so many maps and photographs.

    Args:
        radiance: How many layers of radiance the whole page has.
        photos: How many photographs.
        budget_bytes: What they may weigh together.

    Returns:
        A multiple of 16, from 128 to 768.
    """
    if radiance < 0 or photos < 0 or budget_bytes <= 0:
        raise UsageError("Give numbers of layers that are not negative, and a budget above 0.")
    per_px = radiance * _RADIANCE_BYTES_PER_PX
    per_px += photos * _PHOTO_BYTES_PER_PX * _PHOTO_WIDENING**2
    widest = float(np.sqrt(2 * budget_bytes / max(per_px, 1e-9)))
    width = int(min(widest, LARGEST_WIDTH_PX)) // _WIDTH_STEP_PX * _WIDTH_STEP_PX
    return max(width, _SMALLEST_WIDTH_PX)


def radiance_layer(
    radiance: NDArray[np.float32], label: str, *, width_px: int = 512, gain: float = 1.0
) -> Layer:
    """A light map for the viewer, made smaller with its energy kept.

    Args:
        radiance: (H, 2 H, 3) linear, finite, at least 0.
        label: What it is.
        width_px: The most it may be wide.
        gain: What it is multiplied by to stand beside the entry's first layer.

    Raises:
        ImageError: If it is not equirectangular.
        UsageError: If a value is negative or not finite.
    """
    radiance = np.asarray(radiance, np.float32)
    check_equirectangular(radiance)
    small = resize_radiance(radiance, min(width_px, radiance.shape[1]))
    diffuse, glossy = _lighting(radiance)
    return Layer(
        label=label,
        width_px=small.shape[1],
        height_px=small.shape[0],
        photo=False,
        data=encode_radiance(small),
        diffuse=diffuse,
        glossy=glossy,
        gain=gain,
        median=median_luminance(small),
    )


def photo_layer(
    pixels: NDArray[np.uint8], label: str, *, width_px: int = 512, gain: float = 1.0
) -> Layer:
    """A photograph of the whole sphere for the viewer; it is lit with as if it held all light.

    Args:
        pixels: (H, 2 H, 3) sRGB-encoded.
        label: What it is.
        width_px: Of the maps beside it; the photograph may be half as wide again.
        gain: What its light, 1.0 at its white, is multiplied by to stand beside the first layer.

    Raises:
        ImageError: If it is not equirectangular.
        UsageError: If the pixels are not 8 bits deep.
    """
    check_equirectangular(pixels)
    if pixels.dtype != np.uint8:
        raise UsageError(f"A photograph is uint8, not {pixels.dtype}. Encode it for display first.")
    width = int(min(width_px * _PHOTO_WIDENING, pixels.shape[1])) // 2 * 2
    small = np.asarray(
        cv2.resize(pixels, (width, width // 2), interpolation=cv2.INTER_AREA), np.uint8
    )
    linear = srgb_decode_u8(small).astype(np.float32)
    diffuse, glossy = _lighting(linear)
    return Layer(
        label=label,
        width_px=width,
        height_px=width // 2,
        photo=True,
        data=base64.b64encode(encode_jpeg(small, quality=78)).decode(),
        diffuse=diffuse,
        glossy=glossy,
        gain=gain,
        median=median_luminance(linear),
    )


def _lighting(radiance: NDArray[np.float32]) -> tuple[str, str]:
    """What white and rough balls reflect, for every normal and every mirror direction."""
    diffuse = irradiance_map(radiance, DIFFUSE_WIDTH_PX) / np.float32(np.pi)
    source = resize_radiance(radiance, min(_GLOSSY_SOURCE_WIDTH_PX, radiance.shape[1]))
    blurred = blur_radiance(source, GLOSSY_KAPPA)
    glossy = resize_radiance(blurred, GLOSSY_WIDTH_PX)
    return encode_radiance(np.maximum(diffuse, 0)), encode_radiance(np.maximum(glossy, 0))

"""Pictures inside the page, and what a light map looks like in one."""

import base64
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance, tonemap, weighted_percentile
from panokit.envmap import Anchor, EnvironmentMap
from panokit.io import encode_jpeg
from panokit.sphere import resize_radiance, row_solid_angles

LOWEST_STOP, HIGHEST_STOP = -6, 14
_MIDDLE_GRAY = 0.18
_PALETTE_COLORS = 256


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """An image inside the page.

    Attributes:
        uri: A data URI.
        width_px: Of the pixels.
        height_px: Of the pixels.
        alt: What it shows, for those who cannot see it.
        caption: The line below it.
    """

    uri: str
    width_px: int
    height_px: int
    alt: str
    caption: str = ""


def picture(
    pixels: NDArray[np.uint8], *, alt: str, caption: str = "", quality: int = 80
) -> Picture:
    """A picture for the page from (H, W, 3) display-encoded pixels, as JPEG."""
    height, width = pixels.shape[:2]
    encoded = base64.b64encode(encode_jpeg(pixels, quality=quality)).decode()
    return Picture(
        uri=f"data:image/jpeg;base64,{encoded}",
        width_px=width,
        height_px=height,
        alt=alt,
        caption=caption,
    )


def thumbnail(envmap: EnvironmentMap, name: str, *, width_px: int = 320) -> Picture:
    """A map with everything in it, small: sources and shadows at once."""
    small = resize_radiance(envmap.radiance, min(width_px, envmap.width_px))
    return picture(tonemap(small), alt=f"{name}, tone mapped", quality=76)


def display_gain(envmap: EnvironmentMap) -> float:
    """What brings a map to the brightness of a photograph.

    A map anchored at the camera's white has it already. Another is exposed so that its
    median is middle gray.
    """
    if envmap.anchor is Anchor.LDR_WHITE:
        return 1.0
    median = median_luminance(envmap.radiance)
    return _MIDDLE_GRAY / median if median > 0 else 1.0


def median_luminance(radiance: NDArray[np.float32]) -> float:
    """The median luminance over the sphere of an equirectangular (H, W, 3) map."""
    return weighted_percentile(
        luminance(radiance), row_solid_angles(radiance.shape[0])[:, None], 50
    )


def false_color_palette() -> NDArray[np.uint8]:
    """Colors of luminance from LOWEST_STOP to HIGHEST_STOP over the median; (256, 3) sRGB."""
    index = np.arange(_PALETTE_COLORS, dtype=np.uint8)[None, :]
    return np.ascontiguousarray(cv2.applyColorMap(index, cv2.COLORMAP_TURBO)[0, :, ::-1])

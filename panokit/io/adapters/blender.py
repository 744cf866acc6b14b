"""Blender: the same pixels, as RGBA from the bottom row up.

An equirectangular environment texture has +Z up and +X at its center: with d of panokit,
(-z, -x, y). In a scene whose north is +Y, set the Z rotation of a Mapping node before the texture
to -90 degrees (it turns the direction that is looked up) for panokit's north, the center, to lie
there; the script of `blender_world_script` does so.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError
from panokit.frames import Frame


def to_blender(envmap: EnvironmentMap) -> NDArray[np.float32]:
    """The array (H, W, 4) for `image.pixels.foreach_set(array.ravel())`.

    Make the image with `bpy.data.images.new(name, W, H, float_buffer=True)` and set its color
    space to a linear one ("Linear Rec.709", or "Linear" before Blender 4).
    """
    return rgba_from_the_bottom(envmap.radiance)


def from_blender(
    pixels: NDArray[np.floating[Any]], *, frame: Frame = Frame.LEVEL
) -> EnvironmentMap:
    """A map from the pixels of a Blender image, (H, W, 4), or flat as `image.pixels` gives them.

    Raises:
        ImageError: If they are not 2:1, or not physical.
    """
    pixels = np.asarray(pixels, np.float32)
    if pixels.ndim == 1:
        height = round(np.sqrt(pixels.size / 8))
        if height < 1 or 8 * height**2 != pixels.size:
            raise ImageError(
                f"{pixels.size} values are no RGBA picture of 2:1. Give them as (H, W, 4).",
                reason="not-equirectangular",
            )
        pixels = pixels.reshape(height, 2 * height, 4)
    return EnvironmentMap(radiance=rgb_from_the_top(pixels), frame=frame)


def rgba_from_the_bottom(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """RGB from the top (H, W, 3) as opaque RGBA whose first row is the lowest."""
    rgba = np.ones((*radiance.shape[:2], 4), np.float32)
    rgba[..., :3] = radiance[::-1]
    return rgba


def rgb_from_the_top(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """The other way; alpha is dropped.

    Raises:
        ImageError: If the pixels are not (H, W, 4) or (H, W, 3).
    """
    if pixels.ndim != 3 or pixels.shape[2] not in (3, 4):
        raise ImageError(f"Expected pixels (H, W, 4), not {pixels.shape}.", reason="wrong-channels")
    return np.ascontiguousarray(pixels[::-1, :, :3])

"""Read an equirectangular picture at any direction, right at the seam and at the poles."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.frames import Rotation
from panokit.sphere.equirect import Equirectangular, equirect_directions
from panokit.sphere.pixel_map import Interpolation, apply_map, map_directions

_STRIP_PIXELS = 1 << 21


def sample(
    picture: NDArray[Any],
    directions: NDArray[np.floating],
    *,
    interpolation: Interpolation = "linear",
) -> NDArray[Any]:
    """The picture's value in each direction.

    Where the result shows the picture smaller than it is, resize the picture first, or use
    `reproject`: this function does not average.

    Args:
        picture: (H, W) or (H, W, C), uint8 or float32, equirectangular.
        directions: (h, w, 3), of any length.
        interpolation: "linear"; "spline", sharper; or "nearest", for masks and labels.

    Returns:
        (h, w) or (h, w, C) in the picture's dtype.

    Raises:
        UsageError: If the picture is of another dtype, or its width is odd.
    """
    height, width = picture.shape[:2]
    found = map_directions(directions, Equirectangular(), width, height)
    return apply_map(picture, found, interpolation=interpolation)


def rotate_pixels(
    picture: NDArray[Any],
    target_from_source: Rotation,
    *,
    interpolation: Interpolation = "linear",
) -> NDArray[Any]:
    """The picture as it looks in a rotated frame; for display pixels and masks.

    For radiance use `rotate_radiance`, which keeps the energy. Works strip by strip, so a
    16384x8192 picture needs little more than itself twice. To turn many pictures alike, make
    a `pixel_map` once and apply it to each.

    Args:
        picture: (H, W) or (H, W, C), uint8 or float32.
        target_from_source: What was at direction d in the picture is at
            `target_from_source.apply(d)` in the result.
        interpolation: As of `sample`.
    """
    height, width = picture.shape[:2]
    if interpolation == "spline":
        directions = target_from_source.inverse.apply(equirect_directions(width, height))
        return sample(picture, directions, interpolation="spline")
    rotated = np.empty_like(picture)
    strip = max(1, _STRIP_PIXELS // width)
    for top in range(0, height, strip):
        rows = slice(top, min(top + strip, height))
        directions = target_from_source.inverse.apply(equirect_directions(width, height, rows))
        rotated[rows] = sample(picture, directions, interpolation=interpolation)
    return rotated

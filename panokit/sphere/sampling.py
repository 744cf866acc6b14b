"""Read an equirectangular picture at any direction, right at the seam and at the poles."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.sphere.equirect import equirect_directions, equirect_pixel

# cv2.remap is exact in float32 and uint8; on float64 with borders it writes zeros (5.0.0).
_PICTURE_TYPES = (np.dtype(np.uint8), np.dtype(np.float32))
_STRIP_PIXELS = 1 << 21


def pad_sphere(picture: NDArray[Any], pad_px: int = 1) -> NDArray[Any]:
    """The picture with `pad_px` more pixels on each side, as the sphere continues there.

    Columns wrap; above the zenith the picture goes on at the opposite azimuth, so rows are
    mirrored and rolled by half the width.
    """
    width = picture.shape[1]
    if width % 2:
        raise UsageError(f"A spherical picture has an even width; this one has {width}.")
    above = np.roll(picture[:pad_px][::-1], width // 2, axis=1)
    below = np.roll(picture[-pad_px:][::-1], width // 2, axis=1)
    tall = np.concatenate([above, picture, below], axis=0)
    return np.concatenate([tall[:, -pad_px:], tall, tall[:, :pad_px]], axis=1)


def sample(
    picture: NDArray[Any], directions: NDArray[np.floating], *, nearest: bool = False
) -> NDArray[Any]:
    """The picture's value in each direction, by linear interpolation on the sphere.

    Where the result shows the picture smaller than it is, resize the picture first: this
    function does not average.

    Args:
        picture: (H, W) or (H, W, C), uint8 or float32, equirectangular.
        directions: (h, w, 3), of any length.
        nearest: Take the nearest pixel instead; for masks and labels.

    Returns:
        (h, w) or (h, w, C) in the picture's dtype.
    """
    if picture.dtype not in _PICTURE_TYPES:
        raise UsageError(f"Pictures to sample are uint8 or float32, not {picture.dtype}.")
    height, width = picture.shape[:2]
    padded = pad_sphere(np.asarray(picture))
    column, row = equirect_pixel(directions, width, height)
    method = cv2.INTER_NEAREST if nearest else cv2.INTER_LINEAR
    return cv2.remap(
        padded,
        np.asarray(column + 1, np.float32),
        np.asarray(row + 1, np.float32),
        method,
        borderMode=cv2.BORDER_REPLICATE,
    )


def rotate_pixels(
    picture: NDArray[Any], target_from_source: Rotation, *, nearest: bool = False
) -> NDArray[Any]:
    """The picture as it looks in a rotated frame; for display pixels and masks.

    For radiance use `rotate_radiance`, which keeps the energy. Works strip by strip, so a
    16384x8192 picture needs little more than itself twice.

    Args:
        picture: (H, W) or (H, W, C), uint8 or float32.
        target_from_source: What was at direction d in the picture is at
            `target_from_source.apply(d)` in the result.
        nearest: Take the nearest pixel; for masks.
    """
    height, width = picture.shape[:2]
    rotated = np.empty_like(picture)
    strip = max(1, _STRIP_PIXELS // width)
    for top in range(0, height, strip):
        rows = slice(top, min(top + strip, height))
        directions = equirect_directions(width, height, rows)
        rotated[rows] = _sample_wrapped(
            picture, target_from_source.inverse.apply(directions), nearest
        )
    return rotated


def _sample_wrapped(
    picture: NDArray[Any], directions: NDArray[np.floating], nearest: bool
) -> NDArray[Any]:
    # Padding a big picture for each strip would copy it each time; BORDER_WRAP needs no copy
    # and is right in x.
    height, width = picture.shape[:2]
    column, row = equirect_pixel(directions, width, height)
    inside = np.clip(row, 0, height - 1)
    sampled = _remap(picture, column, inside, nearest)
    beyond = np.nonzero(row != inside)
    if nearest or not len(beyond[0]):
        return sampled
    # Within half a row of a pole the next pixel lies across it, at the opposite azimuth.
    share = np.abs(row - inside)[beyond][:, None]
    across = _remap(picture, column[beyond][:, None] + width / 2, inside[beyond][:, None], False)
    near = sampled[beyond].reshape(len(share), -1)
    mixed = (1 - share) * near + share * across.reshape(near.shape)
    if sampled.dtype == np.uint8:
        mixed = np.rint(mixed)
    sampled[beyond] = mixed.astype(sampled.dtype).reshape(sampled[beyond].shape)
    return sampled


def _remap(
    picture: NDArray[Any], column: NDArray[np.floating], row: NDArray[np.floating], nearest: bool
) -> NDArray[Any]:
    return cv2.remap(
        np.asarray(picture),
        np.asarray(column, np.float32),
        np.asarray(row, np.float32),
        cv2.INTER_NEAREST if nearest else cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_WRAP,
    )

"""Cubic B-spline interpolation: the sharp filter, with no rings around suns.

The picture is first turned into spline coefficients (Unser, Aldroubi and Eden 1993, "B-Spline
Signal Processing"), so that the spline goes through every pixel; each value of the result is
then a weighted sum of 4x4 coefficients. All sixteen weights are positive, so four linear
look-ups at the right places fetch them (Sigg and Hadwiger 2005, "Fast Third-Order Texture
Filtering"), and OpenCV's fast linear remap does the work.
"""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

# The pole of the cubic spline's inverse filter. It falls by 0.27 a pixel: after 12, 1e-7.
_POLE = float(np.sqrt(3) - 2)
_REACH_PX = 9
# How much further from a picture's pixels the spline reads.
BORDER_PX = _REACH_PX + 3
# How far a result may leave the range of the pixels around it, as a share of that range: the
# crest of a wave lies between pixels, but a ring around a lamp does not.
_OVERSHOOT = 0.15
_STRIP_PIXELS = 1 << 17


def spline_coefficients(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """The cubic B-spline through the pixels of a picture with a border of `BORDER_PX`.

    Args:
        picture: (H, W) or (H, W, C) float32; the outer `_REACH_PX` pixels of the result are
            not exact.
    """
    reach = np.arange(-_REACH_PX, _REACH_PX + 1)
    kernel = np.float32(-6 * _POLE / (1 - _POLE**2)) * np.float32(_POLE) ** np.abs(reach)
    kernel /= kernel.sum()
    filtered = cv2.sepFilter2D(picture, -1, kernel, kernel, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(filtered, np.float32)


def spline_remap(
    picture: NDArray[np.float32], column: NDArray[np.float32], row: NDArray[np.float32]
) -> NDArray[np.float32]:
    """The picture at pixel coordinates (h, w), by a cubic B-spline whose ringing is limited.

    Where the pixels around a place differ little the spline is exact to the fourth order;
    beside a bright lamp the result stays near the range of the 3x3 pixels around the place,
    and never falls below half of the darkest of them.

    Args:
        picture: (H, W) or (H, W, C) float32, with a border of `BORDER_PX` around what is read.
        column: (h, w) float32, pixel centers at integers.
        row: (h, w) float32.

    Returns:
        (h, w) or (h, w, C) float32.
    """
    coefficients = spline_coefficients(picture)
    floor, ceiling = _allowed_range(picture)
    result = np.empty((*column.shape, *picture.shape[2:]), np.float32)
    strip = max(1, _STRIP_PIXELS // column.shape[1])
    for top in range(0, column.shape[0], strip):
        part = slice(top, top + strip)
        values = _four_lookups(coefficients, column[part], row[part])
        low = cv2.remap(floor, column[part], row[part], cv2.INTER_NEAREST)
        high = cv2.remap(ceiling, column[part], row[part], cv2.INTER_NEAREST)
        np.clip(values, low, high, out=result[part])
    return result


def _allowed_range(picture: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    around = np.ones((3, 3), np.uint8)
    floor: NDArray[Any] = np.asarray(cv2.erode(picture, around))
    ceiling: NDArray[Any] = np.asarray(cv2.dilate(picture, around))
    room = ceiling - floor
    room *= np.float32(_OVERSHOOT)
    ceiling += room
    half = floor / 2
    floor -= room
    # For a negative value its half would be above it: such a picture is not radiance.
    np.maximum(floor, half, out=floor, where=half >= 0)
    return floor, ceiling


def _four_lookups(
    coefficients: NDArray[np.float32], column: NDArray[np.float32], row: NDArray[np.float32]
) -> NDArray[np.float32]:
    left, right, share_right = _pairs(column)
    above, below, share_below = _pairs(row)
    if coefficients.ndim == 3:
        share_right, share_below = share_right[..., None], share_below[..., None]
    linear = cv2.INTER_LINEAR
    upper: NDArray[Any] = cv2.remap(coefficients, left, above, linear)
    upper += share_right * (cv2.remap(coefficients, right, above, linear) - upper)
    lower: NDArray[Any] = cv2.remap(coefficients, left, below, linear)
    lower += share_right * (cv2.remap(coefficients, right, below, linear) - lower)
    upper += share_below * (lower - upper)
    return upper


def _pairs(
    place: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Where to read the first two and the last two of four coefficients, and the latter's share."""
    whole = np.floor(place)
    f = place - whole
    square = f * f
    cube = square * f
    # The cubic B-spline's weights of the pixels at -1, 0, 1, 2.
    last = cube * np.float32(1 / 6)
    second = np.float32(2 / 3) - square + cube * np.float32(0.5)
    third = np.float32(1 / 6) + np.float32(0.5) * (f + square - cube)
    share = third + last
    return whole - 1 + second / (1 - share), whole + 1 + last / share, share

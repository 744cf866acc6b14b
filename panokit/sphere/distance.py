"""How far pixels are from a region, the same to the last bit wherever it is computed."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray


def pixel_distance(outside: NDArray[Any]) -> NDArray[np.float32]:
    """The distance of each pixel to the nearest that is zero, on a flat picture.

    The last bit of OpenCV's square roots depends on where in memory the picture lies. Squares of
    distances between pixels are whole numbers, so theirs does not.

    Args:
        outside: (H, W) bool or uint8; pad it first if it is to be round, see `pad_sphere`.

    Returns:
        (H, W) float32 in pixels; 0 where `outside` is.
    """
    picture = np.ascontiguousarray(outside, np.uint8)
    found = cv2.distanceTransform(picture, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.sqrt(np.rint(np.square(found, dtype=np.float64))).astype(np.float32)

"""Which pixels of an object show the same material: k-means on their color."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.lab import lab_from_rgb
from panokit.errors import UsageError

_ATTEMPTS = 4
_STOP = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 0.1)
# Light and shadow change a surface's lightness more than its color.
_LIGHTNESS_WEIGHT = 0.5


def segment_materials(
    picture: NDArray[np.floating[Any]], mask: NDArray[np.bool_], count: int = 3, *, seed: int = 0
) -> NDArray[np.uint8]:
    """The material of each pixel, 1 to `count`, the one with most pixels first; 0 off the object.

    Clusters of L*a*b*, with lightness at half weight; the 2018 thesis clusters RGB values.

    Args:
        picture: (H, W, 3), display-encoded in [0, 1].
        mask: (H, W), the object's pixels.
        count: How many materials there are; fewer come out where there are fewer colors.
        seed: For the starting points.

    Returns:
        (H, W) uint8.

    Raises:
        UsageError: If the shapes do not fit, or `count` is not between 1 and 255.
    """
    if picture.shape != (*mask.shape, 3):
        raise UsageError(f"The mask of a picture {picture.shape} is not {mask.shape}.")
    if not 1 <= count <= 255:
        raise UsageError(f"There are between 1 and 255 materials, not {count}.")
    found = np.zeros(mask.shape, np.uint8)
    colors = lab_from_rgb(np.asarray(picture, np.float32)[mask])
    colors[:, 0] *= _LIGHTNESS_WEIGHT
    count = min(count, len(np.unique(colors, axis=0)))
    if count == 0:
        return found
    cv2.setRNGSeed(seed)
    no_labels = np.empty(0, np.int32)
    _, labels, _ = cv2.kmeans(
        np.ascontiguousarray(colors), count, no_labels, _STOP, _ATTEMPTS, cv2.KMEANS_PP_CENTERS
    )
    labels = labels.ravel()
    by_size = np.argsort(-np.bincount(labels, minlength=count), kind="stable")
    rank = np.empty(count, np.uint8)
    rank[by_size] = np.arange(1, count + 1)
    found[mask] = rank[labels]
    return found

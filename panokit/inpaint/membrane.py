"""The smoothest surface through what is known: a pyramid that averages up and fills down."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray


def membrane(
    picture: NDArray[np.float32], known: NDArray[np.bool_], *, wraps: bool = False
) -> NDArray[np.float32]:
    """The picture with its unknown pixels replaced by a smooth surface; known ones unchanged.

    Push-pull (Gortler et al. 1996, "The Lumigraph", section 3.4): average the known pixels
    over ever larger blocks, then come back down and take from the larger block what is still
    unknown in the smaller.

    Args:
        picture: (H, W, C) float32; values where not known are ignored.
        known: (H, W) bool.
        wraps: Whether the left and right edges meet, as on a whole sphere.

    Returns:
        (H, W, C) float32; all zero if nothing is known.
    """
    if known.all():
        return picture
    filled = _pull(picture, known.astype(np.float32), wraps)
    return np.where(known[..., None], picture, filled)


def _pull(
    values: NDArray[np.float32], weights: NDArray[np.float32], wraps: bool
) -> NDArray[np.float32]:
    """Fill one level: from its own values as far as they have weight, the rest from the next."""
    height, width = weights.shape
    if height * width == 1 or weights.min() >= 1:
        return values
    share = _halved(weights)
    means = _halved(values * weights[..., None]) / np.maximum(share, 1e-6)[..., None]
    # Half of a block known is enough for its mean to count in full.
    coarse = _pull(means.astype(np.float32), np.minimum(2 * share, 1), wraps)
    below = _enlarged(coarse, width, height, wraps)
    return np.asarray(below + (values - below) * weights[..., None], np.float32)


def _halved(values: NDArray[np.float32]) -> NDArray[np.float32]:
    height, width = values.shape[:2]
    size = (max(1, -(-width // 2)), max(1, -(-height // 2)))
    smaller = cv2.resize(values, size, interpolation=cv2.INTER_AREA)
    # OpenCV drops the last axis where it has length one.
    return np.asarray(smaller, np.float32).reshape(size[1], size[0], *values.shape[2:])


def _enlarged(
    coarse: NDArray[np.float32], width: int, height: int, wraps: bool
) -> NDArray[np.float32]:
    """Twice the size, smoothly; with `wraps` also across the left and right edge."""
    margin = 1 if wraps else 0
    source: NDArray[Any] = coarse
    if wraps:
        source = np.concatenate([coarse[:, -1:], coarse, coarse[:, :1]], axis=1)
    scale = width / coarse.shape[1]
    padded_width = width + round(2 * margin * scale)
    larger = cv2.resize(source, (padded_width, height), interpolation=cv2.INTER_LINEAR)
    start = (padded_width - width) // 2
    cut = larger[:, start : start + width]
    return np.asarray(cut.reshape(height, width, -1), np.float32)

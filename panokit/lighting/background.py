"""The background without the object, as blurred as that of the pictures networks learned from."""

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.inpaint.membrane import membrane

_LEAST_KNOWN = 0.05


def behind_object(
    linear: NDArray[np.float32], known: NDArray[np.bool_], blur: float
) -> NDArray[np.float32]:
    """What is behind an object: the rest of the picture, drawn on smoothly where it stands.

    A dataset's background is a map whose pixels are `blur` of the picture wide, interpolated
    (`panokit.dataset.photograph.blurred_background`); so is this.

    Args:
        linear: (N, N, 3) float32 linear radiance.
        known: (N, N) bool, where it shows the background.
        blur: The width of a pixel of the blurred picture, in parts of the picture's width; 0
            leaves it sharp.

    Returns:
        (N, N, 3) float32; black if nothing of the background is known.
    """
    size = linear.shape[0]
    cells = size if blur <= 0 else min(size, max(4, round(1 / blur)))
    weights = known.astype(np.float32)
    if cells < size:
        shape = (cells, cells)
        sums = cv2.resize(linear * weights[..., None], shape, interpolation=cv2.INTER_AREA)
        share = cv2.resize(weights, shape, interpolation=cv2.INTER_AREA)
    else:
        sums, share = linear * weights[..., None], weights
    means = np.asarray(sums / np.maximum(share, 1e-6)[..., None], np.float32)
    filled = membrane(means, np.asarray(share > _LEAST_KNOWN))
    if cells == size:
        return filled
    larger = cv2.resize(filled, (size, size), interpolation=cv2.INTER_LINEAR)
    return np.asarray(np.maximum(larger, 0), np.float32)

"""The one gain that relative radiance leaves open."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ItemError
from panokit.sphere import row_solid_angles

DARKEST_CODE, BRIGHTEST_CODE = 3, 245


def alignment_gain(
    estimate: NDArray[np.floating[Any]], truth: NDArray[np.floating[Any]], ldr: NDArray[np.uint8]
) -> float:
    """The factor on the estimate that fits it best to the truth where the LDR picture knew it.

    s = sum(w p g) / sum(w p^2) over the RGB samples of the pixels that are clipped at neither
    end, with solid angles as weights: the field's convention, with the weights of the sphere
    added. Pixels with a channel below `DARKEST_CODE` or above `BRIGHTEST_CODE` count as
    clipped: JPEG blurs the ends, and one lamp taken for unclipped would decide the gain.

    Args:
        estimate: (H, W, 3), linear.
        truth: (H, W, 3), linear.
        ldr: (H, W, 3), the picture that the estimate was made from.

    Raises:
        ItemError: If no pixel can be compared.
    """
    inside = (ldr.min(axis=2) >= DARKEST_CODE) & (ldr.max(axis=2) <= BRIGHTEST_CODE)
    height, width = inside.shape
    weights = inside * row_solid_angles(height, width)[:, None]
    norm = float(np.einsum("hw,hwc,hwc->", weights, estimate, estimate))
    if norm <= 0:
        raise ItemError(
            "No pixel of the picture is clipped at neither end, so the scale of the estimate "
            "cannot be compared. Judge a picture with some unclipped pixels.",
            reason="nothing-unclipped",
        )
    return float(np.einsum("hw,hwc,hwc->", weights, estimate, truth)) / norm

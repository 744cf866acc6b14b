"""Rec.709 luminance, and statistics of it over the sphere."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

# ITU-R BT.709: the luminance of linear RGB with white D65.
REC709_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float64)
REC709_LUMINANCE.setflags(write=False)


def luminance(linear: NDArray[np.floating[Any]]) -> NDArray[np.floating[Any]]:
    """The luminance of linear Rec.709 values, (..., 3) -> (...); the dtype is kept."""
    linear = np.asarray(linear)
    return np.asarray(linear @ REC709_LUMINANCE.astype(linear.dtype))


def weighted_percentile(
    values: NDArray[np.floating[Any]], weights: NDArray[np.floating[Any]], percent: float
) -> float:
    """The value below which `percent` of the weight lies; weights broadcast to the values.

    With solid angles as weights this is a percentile over the sphere.
    """
    flat = np.asarray(values).ravel()
    weight = np.broadcast_to(weights, np.shape(values)).ravel()
    order = np.argsort(flat)
    reached = np.cumsum(weight[order], dtype=np.float64)
    index = int(np.searchsorted(reached, percent / 100 * reached[-1]))
    return float(flat[order[min(index, len(order) - 1)]])

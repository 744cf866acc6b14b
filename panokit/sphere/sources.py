"""Connected regions on the sphere: lamps, suns, holes."""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


def label_regions(mask: NDArray[np.bool_]) -> tuple[NDArray[np.int32], int]:
    """Number the connected regions of a mask, also across the seam and over the poles.

    Pixels are neighbors if they touch at an edge or a corner.

    Args:
        mask: (H, W) bool, equirectangular.

    Returns:
        (H, W) int32 labels, 0 outside the mask and 1..n in it, and n.
    """
    count, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    flat: NDArray[np.int32] = labels.astype(np.int32, copy=False)
    pairs = [_touching(flat[:, -1], flat[:, 0])]
    half = mask.shape[1] // 2
    for row in (flat[0], flat[-1]):
        pairs.append(_touching(row, np.roll(row, half)))
    a, b = np.concatenate(pairs, axis=1)
    graph = coo_array((np.ones(len(a), bool), (a, b)), shape=(count, count))
    merged_count, merged = connected_components(graph, directed=False)
    # The background keeps the number 0; it is never part of a pair.
    order = np.full(merged_count, -1)
    order[merged[0]] = 0
    order[order < 0] = np.arange(1, merged_count)
    return order[merged][flat].astype(np.int32), merged_count - 1


def _touching(a: NDArray[np.int32], b: NDArray[np.int32]) -> NDArray[np.int32]:
    """Pairs of labels that meet along two lines of pixels, diagonals included; shape (2, n)."""
    met = [(a, b), (a[1:], b[:-1]), (a[:-1], b[1:])]
    pairs = np.concatenate([np.stack(pair) for pair in met], axis=1)
    return pairs[:, (pairs > 0).all(axis=0)]

"""Connected regions on the sphere: lamps, suns, holes."""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from panokit.equirectangular import check_equirectangular
from panokit.errors import ImageError
from panokit.sphere.solid_angle import pixel_solid_angles

# How far from two burnt-out channels one alone still counts: the rim of a lamp.
_RIM_DEG = 1.0
# As large as a disk of 2 degrees radius: a brake light a meter away.
_SMALL_SR = 0.004


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


def saturated_mask(pixels: NDArray[np.uint8], level: int = 250) -> NDArray[np.bool_]:
    """Where a display-encoded picture is burnt out, lamps of any color but no blue sky.

    One channel alone does not tell. All three at the limit misses sodium lamps, whose blue
    never gets there; any one at the limit takes a blue sky for a lamp. So: a pixel with two
    channels at the limit is burnt out, since what is left of its hue cannot be read. One
    with a single channel counts within a degree of those: the rim of a lamp. A region that
    has one channel at the limit, not blue, and no such pixels counts if it is small: a brake
    light.

    Args:
        pixels: (H, W, 3) uint8, equirectangular, sRGB-encoded.
        level: A channel from here up is at the limit.

    Returns:
        (H, W) bool.
    """
    check_equirectangular(pixels)
    if pixels.dtype != np.uint8:
        raise ImageError(
            f"Burnt-out pixels are sought in uint8 pictures, not {pixels.dtype}. Encode the "
            "picture first; in radiance, use find_lights.",
            reason="wrong-dtype",
        )
    full = pixels >= level
    core = np.count_nonzero(full, axis=2) >= 2
    any_full = np.asarray(full.any(axis=2))
    labels, count = label_regions(any_full)
    solid_angles = pixel_solid_angles(*core.shape)
    area = np.bincount(labels.ravel(), solid_angles.ravel(), count + 1)
    blue_only = full[..., 2] & ~full[..., 0] & ~full[..., 1]
    blue = np.bincount(labels.ravel(), (solid_angles * blue_only).ravel(), count + 1)
    lamp = (area <= _SMALL_SR) & (blue < 0.5 * area)
    lamp[0] = False
    return np.asarray(core | (any_full & _widened(core)) | lamp[labels])


def _widened(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The mask and what lies within `_RIM_DEG` of it in rows and columns, across the seam."""
    reach = max(round(mask.shape[1] * _RIM_DEG / 360), 1)
    wrapped = np.pad(mask.astype(np.uint8), ((0, 0), (reach, reach)), mode="wrap")
    size = 2 * reach + 1
    wide = cv2.dilate(wrapped, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size)))
    return np.asarray(wide[:, reach:-reach] > 0)

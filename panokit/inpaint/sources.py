"""What in the surroundings of a hole is fit to be copied: no lamps, nothing that stands out."""

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.sphere.distance import pixel_distance

# Gray levels: the encoding puts white at 255, and what a lamp adds to it above.
_HIGHLIGHT = 240
_MOST_HIGHLIGHTS = 0.08
_BINS = 12
_LEVELS_PER_BIN = 24.0
_RING_SHARE = 0.5
_STRANGEST = 4.0
_PATCH_PX = 9


def highlights(picture: NDArray[np.float32], known: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Bright spots with their glow, (N, N) bool; none where much of the view is bright.

    Single bright pebbles are no lamps.
    """
    bright = (picture.min(axis=2) >= _HIGHLIGHT) & known
    if bright.sum() > _MOST_HIGHLIGHTS * known.sum():
        # That is a white wall or an overcast sky, not a lamp.
        return np.zeros_like(bright)
    speck = np.ones((max(1, len(picture) // 200),) * 2)
    glow = np.ones((2 * max(1, len(picture) // 40) + 1,) * 2)
    lamps = cv2.erode(bright.astype(np.uint8), speck)
    return np.asarray(cv2.dilate(lamps, glow) > 0)


def strangeness(
    picture: NDArray[np.float32], known: NDArray[np.bool_], hole: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """How little each pixel looks like the ring around the hole, (N, N) float32, 0 to 4.

    The logarithm of how much rarer its color is there than a typical one; 0 for typical ones.

    Args:
        picture: (N, N, 3) float32, in gray levels.
        known: (N, N) bool.
        hole: (N, N) bool.
    """
    soft = cv2.blur(picture, (5, 5), borderType=cv2.BORDER_REFLECT)
    place = np.clip(soft / _LEVELS_PER_BIN, 0, _BINS - 1)
    away = pixel_distance(~hole)
    ring = known & (away < _RING_SHARE * np.sqrt(hole.sum()))
    if not ring.any():
        return np.zeros(known.shape, np.float32)
    count, _ = np.histogramdd(place[ring], bins=_BINS, range=[(0, _BINS)] * 3)
    for axis in range(3):
        padded = np.pad(count, [(1, 1) if a == axis else (0, 0) for a in range(3)])
        low, mid, high = (np.take(padded, np.arange(k, k + _BINS), axis=axis) for k in range(3))
        count = low + 2 * mid + high
    index = place.astype(np.intp)
    density = count[index[..., 0], index[..., 1], index[..., 2]]
    typical = np.median(density[ring])
    rarity = np.log(typical / np.maximum(density, typical * 1e-6))
    # A factor of two or three is nothing; a color that is not there at all is.
    return np.clip(rarity - 1, 0, _STRANGEST).astype(np.float32)


def uniqueness(
    features: NDArray[np.float32],
    known: NDArray[np.bool_],
    hole: NDArray[np.bool_],
    offsets: list[tuple[int, int]],
) -> NDArray[np.float32]:
    """By how much each pixel's patch differs from all others compared with it, (N, N) float32.

    In gray levels above what is typical around the hole. Something that is there only once
    gives a copy away.

    Args:
        features: (N, N, C) float32.
        known: (N, N) bool.
        hole: (N, N) bool.
        offsets: With what lies so many rows and columns away a patch is compared.
    """
    height, width = known.shape
    least = np.full(known.shape, np.inf, np.float32)
    weight = known.astype(np.float32)
    for down, right in [o for offset in offsets for o in (offset, (-offset[0], -offset[1]))]:
        if abs(down) >= height or abs(right) >= width:
            continue
        own = np.s_[max(0, -down) : height - max(0, down), max(0, -right) : width - max(0, right)]
        other = np.s_[max(0, down) : height + min(0, down), max(0, right) : width + min(0, right)]
        both = weight[own] * weight[other]
        difference = features[own] - features[other]
        length = np.sqrt(np.einsum("...c,...c->...", difference, difference)) * both
        share = cv2.blur(both, (_PATCH_PX, _PATCH_PX))
        mean = cv2.blur(length, (_PATCH_PX, _PATCH_PX)) / np.maximum(share, 1e-6)
        mean[share < 0.7] = np.inf
        np.minimum(least[own], mean, out=least[own])
    away = pixel_distance(~hole)
    ring = known & (away < _RING_SHARE * np.sqrt(hole.sum())) & np.isfinite(least)
    if not ring.any():
        return np.zeros(known.shape, np.float32)
    least[~np.isfinite(least)] = least[ring].max()
    return np.maximum(least - 1.3 * np.median(least[ring]), 0).astype(np.float32)

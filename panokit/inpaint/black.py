"""Find what never came: tiles left black, bars of a grid of the wrong size."""

import cv2
import numpy as np
from numpy.typing import NDArray

# Of 255; an encoder leaves this much in a black tile.
_BLACK = 2
_LEAST_SHARE = 5e-4
# The edge of a union of tiles is made of long upright and level lines; that of a night sky
# between roofs is not.
_LEAST_STRAIGHT = 0.9
# How much brighter the picture goes on right beside it, and along how much of the edge.
_BRIGHTER, _LEAST_EDGE = 6, 0.6


def find_black(
    pixels: NDArray[np.uint8], valid: NDArray[np.bool_] | None = None
) -> tuple[NDArray[np.bool_], float]:
    """Large black regions with straight edges that the picture breaks off at.

    Args:
        pixels: (H, W, 3) uint8.
        valid: (H, W) bool; what the picture itself says is missing needs no finding.

    Returns:
        (H, W) bool, and the confidence: how straight and how sudden the edges are, at worst.
    """
    height, width = pixels.shape[:2]
    found, confidence = np.zeros((height, width), np.bool_), 1.0
    black = (pixels.max(axis=2) <= _BLACK).astype(np.uint8)
    if valid is not None:
        black &= valid.view(np.uint8)
    if black.mean() < _LEAST_SHARE:
        return found, 0.0
    count, labels, boxes, _ = cv2.connectedComponentsWithStats(black, connectivity=4)
    for label in range(1, count):
        left, top, wide, high, area = (int(value) for value in boxes[label])
        if area < _LEAST_SHARE * height * width:
            continue
        margin = 6
        window = np.s_[max(0, top - margin) : top + high + margin,
                       max(0, left - margin) : left + wide + margin]  # fmt: skip
        own = labels[window] == label
        straight = _straightness(own, max(8, height // 32))
        # Encoders ring beside the edge: what counts is a little away from it.
        near = cv2.dilate(own.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
        beside = (cv2.dilate(near.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0) & ~near
        edge = pixels[window][beside].max(axis=-1) > _BLACK + _BRIGHTER
        sudden = float(edge.mean()) if edge.size else 0.0
        if straight >= _LEAST_STRAIGHT and sudden >= _LEAST_EDGE:
            found[window] |= near
            confidence = min(confidence, straight, sudden)
    return found, confidence if found.any() else 0.0


def _straightness(region: NDArray[np.bool_], length_px: int) -> float:
    """The share of a region's edge that lies in upright or level lines of some length."""
    padded = np.pad(region, 1)
    level = (padded[1:] != padded[:-1]).astype(np.uint8)
    upright = (padded[:, 1:] != padded[:, :-1]).astype(np.uint8)
    lines = cv2.morphologyEx(level, cv2.MORPH_OPEN, np.ones((1, length_px), np.uint8)).sum()
    lines += cv2.morphologyEx(upright, cv2.MORPH_OPEN, np.ones((length_px, 1), np.uint8)).sum()
    return float(lines / max(int(level.sum()) + int(upright.sum()), 1))

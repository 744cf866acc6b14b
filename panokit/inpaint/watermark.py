"""Find a mark repeated at the same place in every tile or view, by folding them onto each other.

The scene is different in each; at a place without a mark their fine detail cancels in the
median. What is left is the mark, however faint.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

# In gray levels, of the median over the tiles.
_LEAST_LEVEL = 2.0
# And as a multiple of what chance would leave there.
_LEAST_SIGMAS = 5.0
_FEWEST_TILES = 8
_SMOOTH_PX = 25
_MARGIN_PX = 3
# Encoders leave edges where tiles meet.
_TILE_EDGE_PX = 3
_LEAST_PIXELS = 12
_MEDIAN_TO_SIGMA = 1.4826


def find_watermark(tiles: NDArray[np.uint8]) -> tuple[NDArray[np.bool_], float]:
    """The mark that all tiles have at the same place.

    Args:
        tiles: (N, h, w, 3) uint8; below 8 of them nothing can be said.

    Returns:
        (h, w) bool, the mark with a margin, and the confidence: the share of tiles that show
        it, of those where it does not drown. All False and 0 where there is none.
    """
    count, height, width = tiles.shape[:3]
    mark = np.zeros((height, width), np.bool_)
    if count < _FEWEST_TILES:
        return mark, 0.0
    fine = np.empty((count, height, width), np.float32)
    for number, tile in enumerate(tiles):
        gray = tile.astype(np.float32).mean(axis=2)
        fine[number] = gray - cv2.blur(gray, (_SMOOTH_PX, _SMOOTH_PX))
    middle = np.median(fine, axis=0)
    spread = _MEDIAN_TO_SIGMA * np.median(np.abs(fine - middle), axis=0)
    # The standard error of a median.
    chance = np.sqrt(np.pi / 2) * spread / np.sqrt(count)
    found = np.abs(middle) > np.maximum(_LEAST_LEVEL, _LEAST_SIGMAS * chance)
    edge = _TILE_EDGE_PX
    found[:edge] = found[-edge:] = found[:, :edge] = found[:, -edge:] = False
    number, labels, boxes, _ = cv2.connectedComponentsWithStats(found.astype(np.uint8))
    for label in range(1, number):
        mark |= (labels == label) & (boxes[label][cv2.CC_STAT_AREA] >= _LEAST_PIXELS)
    if not mark.any():
        return mark, 0.0
    sign = np.sign(middle[mark])
    agrees = np.median(fine[:, mark] * sign, axis=1) > np.median(np.abs(middle[mark])) / 2
    kernel = np.ones((2 * _MARGIN_PX + 1,) * 2, np.uint8)
    wide = cv2.morphologyEx(mark.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((9, 9), np.uint8))
    return np.asarray(cv2.dilate(wide, kernel) > 0), float(agrees.mean())


def watermark_on_tiles(pixels: NDArray[np.uint8], tile_px: int) -> tuple[NDArray[np.bool_], float]:
    """The mark of a panorama that was put together from square tiles.

    Args:
        pixels: (H, W, 3) uint8.
        tile_px: Side of the tiles; those cut by the picture's edge are marked like the others.

    Returns:
        (H, W) bool, and the confidence as of `find_watermark`.
    """
    height, width = pixels.shape[:2]
    down, right = height // tile_px, width // tile_px
    whole = pixels[: down * tile_px, : right * tile_px]
    tiles = whole.reshape(down, tile_px, right, tile_px, 3).swapaxes(1, 2)
    mark, confidence = find_watermark(tiles.reshape(down * right, tile_px, tile_px, 3))
    repeats = (-(-height // tile_px), -(-width // tile_px))
    return np.tile(mark, repeats)[:height, :width], confidence

"""Ground: the hole is covered with copies of what is around, joined where it shows least.

OpenCV's shift map finds, on a small version of the view, from where each pixel of the hole
is best copied (He & Sun 2012, "Statistics of Patch Offsets for Image Completion"). Its copies
are exact, so a few fractions of a gray level can carry each pixel's own position through it.
With these positions the copying is done again at the full size, with sharp results.
"""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.inpaint.membrane import membrane
from panokit.inpaint.seams import seam_correction

_COARSE_PX = 224
_SEED = 20260101
_LEAST_KNOWN = 0.1
_HIGHLIGHT = 240
_MOST_HIGHLIGHTS = 0.08
# Two channels carry the position as a fraction of half a gray level, centered on zero.
_POSITION_SCALE = 1 / 1024


def texture(picture: NDArray[np.uint8], known: NDArray[np.bool_]) -> NDArray[np.float32] | None:
    """The view with its unknown pixels replaced by copies of known ones.

    Lamps and glints are smoothed away where they would come along: to a light probe a copied
    highlight is a light that was never there.

    Args:
        picture: (N, N, 3) uint8, flat.
        known: (N, N) bool.

    Returns:
        (N, N, 3) float32, 0 to 255; None if too little is known to copy from.
    """
    size = picture.shape[0]
    coarse_px = min(size, _COARSE_PX)
    coarse = _reduced(picture, coarse_px)
    coarse_known = _reduced(known.astype(np.float32), coarse_px) > 0.999
    if coarse_known.mean() < _LEAST_KNOWN:
        return None
    column, row = _copied_from(coarse.astype(np.uint8), coarse_known)
    correction = seam_correction(coarse.astype(np.float32), coarse_known, column, row)
    marked = np.dstack([picture, 255 * _highlights(picture, known)]).astype(np.float32)
    copied = _copy(marked, column, row)
    filled = copied[..., :3] + cv2.resize(correction, (size, size), interpolation=cv2.INTER_LINEAR)
    full = picture.astype(np.float32)
    filled = np.where(known[..., None], full, np.clip(filled, 0, 255)).astype(np.float32)
    return membrane(filled, known | (copied[..., 3] < 1))


def _reduced(values: NDArray[Any], size_px: int) -> NDArray[Any]:
    return np.asarray(cv2.resize(values, (size_px, size_px), interpolation=cv2.INTER_AREA))


def _highlights(picture: NDArray[np.uint8], known: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Small bright spots with their glow, (N, N) bool; none where much of the view is bright."""
    bright = (picture.min(axis=2) >= _HIGHLIGHT) & known
    if bright.sum() > _MOST_HIGHLIGHTS * known.sum():
        # That is a white wall or an overcast sky, not a lamp.
        return np.zeros_like(bright)
    reach = 2 * max(1, len(picture) // 64) + 1
    glow = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach))
    return np.asarray(cv2.dilate(bright.astype(np.uint8), glow) > 0)


def _copied_from(
    coarse: NDArray[np.uint8], known: NDArray[np.bool_]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The column and row that each pixel of the small view is copied from."""
    size = len(coarse)
    # Lab, because the shift map compares channels as if all counted the same.
    coded = cv2.cvtColor(coarse, cv2.COLOR_RGB2LAB).astype(np.float32)
    row, column = np.mgrid[:size, :size]
    coded[..., 1] += (column - size // 2) * _POSITION_SCALE
    coded[..., 2] += (row - size // 2) * _POSITION_SCALE
    coded[~known] = 0
    result = np.zeros_like(coded)
    # Its search is randomized; the same seed gives the same filling.
    cv2.setRNGSeed(_SEED)
    cv2.xphoto.inpaint(
        coded, np.where(known, 255, 0).astype(np.uint8), result, cv2.xphoto.INPAINT_SHIFTMAP
    )
    fraction = result[..., 1:] - np.rint(result[..., 1:])
    position = np.rint(fraction / _POSITION_SCALE).astype(np.int32) + size // 2
    position = np.clip(position, 0, size - 1)
    return (
        np.where(known, column, position[..., 0]).astype(np.int32),
        np.where(known, row, position[..., 1]).astype(np.int32),
    )


def _copy(
    picture: NDArray[np.float32], column: NDArray[np.int32], row: NDArray[np.int32]
) -> NDArray[np.float32]:
    """Copy at the full size with the shifts found at the small one.

    Each pixel blends the copies that the four nearest small pixels ask for: inside a patch
    they agree and the copy is exact, where patches meet they fade into one another.
    """
    size, coarse_px = len(picture), len(column)
    scale = size / coarse_px
    own_row, own_column = np.mgrid[:coarse_px, :coarse_px]
    shift_x = ((column - own_column) * scale).astype(np.float32)
    shift_y = ((row - own_row) * scale).astype(np.float32)
    full_row, full_column = np.mgrid[:size, :size].astype(np.float32)
    position = (np.arange(size, dtype=np.float32) + 0.5) / scale - 0.5
    first = np.floor(position).astype(int)
    share = position - first
    total = np.zeros_like(picture)
    for down in (0, 1):
        at_row = np.clip(first + down, 0, coarse_px - 1)
        weight_y = share if down else 1 - share
        for right in (0, 1):
            at_column = np.clip(first + right, 0, coarse_px - 1)
            weight_x = share if right else 1 - share
            chosen = np.ix_(at_row, at_column)
            copy = cv2.remap(
                picture,
                full_column + shift_x[chosen],
                full_row + shift_y[chosen],
                cv2.INTER_LINEAR,
                borderMode=cv2.BORDER_REPLICATE,
            )
            total += copy * (weight_y[:, None] * weight_x[None, :])[..., None]
    return total

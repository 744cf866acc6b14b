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
from scipy.ndimage import distance_transform_edt

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
    light = np.asarray(cv2.resize(correction, (size, size), interpolation=cv2.INTER_LINEAR))
    box = _bounds(~known)
    filled = picture.astype(np.float32)
    # A small pixel's copy may reach over its edge into a hole, where nothing odd may be then.
    filled[box] = membrane(filled[box], known[box])
    copied = _copy(
        np.dstack([filled, np.float32(255) * _highlights(picture, known)]), column, row, box
    )
    patch = np.clip(copied[..., :3] + light[box], 0, 255)
    patch = np.where(known[box][..., None], filled[box], patch).astype(np.float32)
    filled[box] = membrane(patch, known[box] | (copied[..., 3] < 1))
    return filled


def _bounds(mask: NDArray[np.bool_]) -> tuple[slice, slice]:
    """The smallest box of rows and columns with every True in it."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if not len(rows):
        return slice(0, 0), slice(0, 0)
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)


def _reduced(values: NDArray[Any], size_px: int) -> NDArray[Any]:
    return np.asarray(cv2.resize(values, (size_px, size_px), interpolation=cv2.INTER_AREA))


def _highlights(picture: NDArray[np.uint8], known: NDArray[np.bool_]) -> NDArray[np.bool_]:
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
    picture: NDArray[np.float32],
    column: NDArray[np.int32],
    row: NDArray[np.int32],
    box: tuple[slice, slice],
) -> NDArray[np.float32]:
    """Copy a box of the view at full size, with the shifts found at the small one.

    Each pixel blends the copies that the four nearest small pixels ask for: inside a patch
    they agree and the copy is exact, where patches meet they fade into one another.
    """
    scale = len(picture) / len(column)
    own_row, own_column = np.mgrid[: len(row), : len(column)]
    stays = (column == own_column) & (row == own_row)
    # A pixel at the rim has neighbors that stay, and must not stay with them.
    to_row, to_column = distance_transform_edt(stays, return_distances=False, return_indices=True)
    # Whole pixels, so that nothing is softened on the way.
    shift_x = np.rint((column - own_column) * scale).astype(np.float32)[to_row, to_column]
    shift_y = np.rint((row - own_row) * scale).astype(np.float32)[to_row, to_column]
    full_row, full_column = np.mgrid[box].astype(np.float32)
    total = np.zeros((*full_row.shape, picture.shape[2]), np.float32)
    for at_row, weight_y in _nearest_two(box[0], scale, len(row)):
        for at_column, weight_x in _nearest_two(box[1], scale, len(column)):
            chosen = np.ix_(at_row, at_column)
            copy = cv2.remap(
                picture,
                full_column + shift_x[chosen],
                full_row + shift_y[chosen],
                cv2.INTER_NEAREST,
                borderMode=cv2.BORDER_REPLICATE,
            )
            total += copy * (weight_y[:, None] * weight_x[None, :])[..., None]
    return total


def _nearest_two(
    pixels: slice, scale: float, coarse_px: int
) -> list[tuple[NDArray[np.intp], NDArray[np.float32]]]:
    """Along one axis, the two small pixels nearest to each pixel, with their linear weights."""
    position = (np.arange(pixels.start, pixels.stop) + 0.5) / scale - 0.5
    first = np.floor(position).astype(np.intp)
    share = (position - first).astype(np.float32)
    last = coarse_px - 1
    return [(np.clip(first, 0, last), 1 - share), (np.clip(first + 1, 0, last), share)]

"""Carry shifts found on a small version of a view over to its full size, to the pixel."""

import cv2
import numpy as np
from numpy.typing import NDArray

_MOST_SAMPLES = 3000
_REACH_SMALL_PX = 8


def adjusted_offsets(
    picture: NDArray[np.float32],
    known: NDArray[np.bool_],
    shifts: NDArray[np.int32],
    hole: NDArray[np.bool_],
) -> NDArray[np.int32]:
    """The shifts at full size, each moved by up to a small pixel to where it fits best.

    Joints of a pavement that meet within a small pixel would be several full pixels apart.
    What fits is judged by what is known next to the piece that is copied, or around the hole
    where nothing is.

    Args:
        picture: (N, N, 3) float32, the full view.
        known: (N, N) bool.
        shifts: (n, n, 2) int32, rows and columns, in small pixels.
        hole: (n, n) bool, where they count.

    Returns:
        (n, n, 2) int32, in full pixels.
    """
    scale = len(picture) / len(shifts)
    result = np.rint(shifts * scale).astype(np.int32)
    if scale <= 1.01:
        return result
    gray = cv2.blur(picture.mean(axis=-1), (3, 3))
    around = _dilated(hole, _REACH_SMALL_PX) & ~hole
    pieces, index = np.unique(shifts[hole], axis=0, return_inverse=True)
    place = np.full(hole.shape, -1)
    place[hole] = index.ravel()
    for number, piece in enumerate(pieces):
        own = place == number
        beside = _dilated(own, _REACH_SMALL_PX) & ~hole
        if beside.sum() < 4 * _REACH_SMALL_PX:
            beside = around
        best = _best(gray, known, beside, piece, scale)
        result[own] = best
    return result


def _best(
    gray: NDArray[np.float32],
    known: NDArray[np.bool_],
    where: NDArray[np.bool_],
    piece: NDArray[np.int32],
    scale: float,
) -> NDArray[np.int32]:
    size = len(gray)
    row, column = np.nonzero(cv2.resize(where.astype(np.uint8), (size, size)) > 0)
    step = max(1, len(row) // _MOST_SAMPLES)
    row, column = row[::step], column[::step]
    ok = known[row, column]
    row, column = row[ok], column[ok]
    first = np.rint(piece * scale).astype(np.int32)
    reach = int(np.ceil(scale / 2)) + 1
    lowest, best = np.inf, first
    if not len(row):
        return first
    own = gray[row, column]
    for down in range(-reach, reach + 1):
        for right in range(-reach, reach + 1):
            r, c = row + first[0] + down, column + first[1] + right
            inside = (r >= 0) & (r < size) & (c >= 0) & (c < size)
            r, c = np.where(inside, r, 0), np.where(inside, c, 0)
            fits = inside & known[r, c]
            if fits.sum() < 50:
                continue
            difference = own[fits] - gray[r[fits], c[fits]]
            # The shift found is right unless another is plainly better.
            score = float(np.abs(difference - difference.mean()).mean())
            score *= 1 + 0.003 * (abs(down) + abs(right))
            if score < lowest:
                lowest, best = score, first + np.array([down, right], np.int32)
    return best


def _dilated(mask: NDArray[np.bool_], reach_px: int) -> NDArray[np.bool_]:
    kernel = np.ones((2 * reach_px + 1,) * 2, np.uint8)
    return np.asarray(cv2.dilate(mask.astype(np.uint8), kernel) > 0)

"""Ground: the hole is covered with copies of what is around, joined where it shows least.

A few shifts of the picture are found that continue it into the hole (`offsets`), and seams
between them where they agree (`labeling`), both on a small version of the view. The copying
is then done at full size, with every shift adjusted to the pixel, and the steps in brightness
that are left between copies are taken out (`seams`).

All of it works on float values on a scale of gray levels, so it is the same for a photograph
and for the logarithm of a light probe.
"""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from panokit.inpaint.adjust import adjusted_offsets
from panokit.inpaint.copies import fine_features, follow, make_copies, make_features
from panokit.inpaint.labeling import best_labels
from panokit.inpaint.membrane import membrane
from panokit.inpaint.offsets import candidate_offsets
from panokit.inpaint.seams import seam_correction
from panokit.inpaint.sources import highlights, strangeness, uniqueness

# The small versions show the hole about this large, one after the other.
_HOLE_PX = (28, 84)
_LARGEST_PX = 288
_BAND_PX = 6
_LEAST_KNOWN = 0.1
# In gray levels, per pixel that looks like nothing around the hole, or is the only one so.
_STRANGE = 1.0
_UNIQUE = 0.1


def texture(picture: NDArray[np.float32], known: NDArray[np.bool_]) -> NDArray[np.float32] | None:
    """The view with its unknown pixels replaced by copies of known ones.

    Lamps and glints are never copied: to a light probe a copied highlight is a light that was
    never there.

    Args:
        picture: (N, N, 3) float32, flat, in gray levels; values where not known are ignored.
        known: (N, N) bool.

    Returns:
        (N, N, 3) float32; None if too little is known to copy from.
    """
    size = picture.shape[0]
    box = _bounds(~known)
    extent = max(box[0].stop - box[0].start, box[1].stop - box[1].start)
    levels = [_level_px(hole_px, size, extent) for hole_px in _HOLE_PX]
    filled = picture.copy()
    # What is copied may reach over its edge into the hole, where nothing odd may be then.
    filled[box] = membrane(filled[box], known[box])
    guide: NDArray[np.float32] | None = None
    tried: list[tuple[int, int]] = []
    shifts: NDArray[np.int32] | None = None
    for px in levels:
        coarse = _reduced(filled, px)
        coarse_known = _reduced(known.astype(np.float32), px) > 0.999
        if coarse_known.mean() < _LEAST_KNOWN:
            return None
        shifts = _shifts(coarse, coarse_known, guide, tried)
        if shifts is None:
            return None
        row, column = np.mgrid[:px, :px] + np.moveaxis(shifts, -1, 0)
        guide = coarse[row, column]
        pieces = np.unique(shifts[~coarse_known], axis=0)
        tried = [(int(d), int(r)) for d, r in np.rint(pieces * (levels[-1] / px)).astype(int)]
    correction = seam_correction(
        coarse, coarse_known, column.astype(np.int32), row.astype(np.int32)
    )
    light = np.asarray(cv2.resize(correction, (size, size), interpolation=cv2.INTER_LINEAR))
    if shifts is None:
        return None
    full = adjusted_offsets(filled, known, shifts, ~coarse_known)
    patch = _copy(filled, full, ~coarse_known, box) + light[box]
    filled[box] = np.where(known[box][..., None], picture[box], patch)
    return filled


def _level_px(hole_px: int, size: int, extent: int) -> int:
    """The size of the small view in which the hole is about so large."""
    return int(np.clip(hole_px / max(extent, 1) * size, min(size, 24), min(size, _LARGEST_PX)))


def _shifts(
    coarse: NDArray[np.float32],
    known: NDArray[np.bool_],
    guide: NDArray[np.float32] | None,
    tried: list[tuple[int, int]],
) -> NDArray[np.int32] | None:
    """From where each pixel of the small view is copied, (n, n, 2) rows and columns away.

    Args:
        coarse: (n, n, 3) float32, a membrane where it is not known.
        known: (n, n) bool.
        guide: A still smaller view already filled, or None.
        tried: Shifts to try besides, in pixels of this view.
    """
    hole = ~known
    source = known & ~highlights(coarse, known)
    features = make_features(coarse, hole)
    # Shifts that fit in color, and those that fit in lines whatever the color.
    lines = fine_features(features)
    fitting = [candidate_offsets(each, hole, source, _BAND_PX) for each in (lines, features)]
    offsets = list(dict.fromkeys([*tried, *fitting[0], *fitting[1]]))
    if not offsets:
        return None
    number = np.full(hole.shape, -1)
    number[hole] = np.arange(hole.sum())
    odd = _STRANGE * strangeness(coarse, known, hole) + _UNIQUE * uniqueness(
        features, known, hole, offsets
    )
    copies = make_copies(features, known, source, odd, number, offsets)
    if guide is not None:
        follow(copies, coarse, guide, offsets)
    labels = best_labels(copies)
    if (labels < 0).all():
        return None
    shifts = np.zeros((*hole.shape, 2), np.int32)
    shifts[hole] = np.asarray(offsets, np.int32)[labels]
    served = np.zeros(hole.shape, np.bool_)
    served[hole] = labels >= 0
    # Where nothing fits, as the nearest pixel for which something does.
    near = distance_transform_edt(~served, return_distances=False, return_indices=True)
    shifts[hole] = shifts[near[0], near[1]][hole]
    place = np.moveaxis(np.mgrid[: hole.shape[0], : hole.shape[1]], 0, -1)
    last = np.array(hole.shape) - 1
    return np.asarray(np.clip(place + shifts, 0, last) - place, np.int32)


def _bounds(mask: NDArray[np.bool_]) -> tuple[slice, slice]:
    """The smallest box of rows and columns with every True in it."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if not len(rows):
        return slice(0, 0), slice(0, 0)
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)


def _reduced(values: NDArray[Any], size_px: int) -> NDArray[Any]:
    return np.asarray(cv2.resize(values, (size_px, size_px), interpolation=cv2.INTER_AREA))


def _copy(
    picture: NDArray[np.float32],
    shifts: NDArray[np.int32],
    hole: NDArray[np.bool_],
    box: tuple[slice, slice],
) -> NDArray[np.float32]:
    """Copy a box of the view at full size, with the shifts found at the small one.

    Each pixel blends the copies that the four nearest small pixels ask for: inside a patch
    they agree and the copy is exact, where patches meet they fade into one another.
    """
    scale = len(picture) / len(shifts)
    # A pixel at the rim has neighbors that stay, and must not stay with them.
    near = distance_transform_edt(~hole, return_distances=False, return_indices=True)
    shift_y = shifts[near[0], near[1], 0].astype(np.float32)
    shift_x = shifts[near[0], near[1], 1].astype(np.float32)
    full_row, full_column = np.mgrid[box].astype(np.float32)
    total = np.zeros((*full_row.shape, picture.shape[2]), np.float32)
    for at_row, weight_y in _nearest_two(box[0], scale, len(shifts)):
        for at_column, weight_x in _nearest_two(box[1], scale, len(shifts)):
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

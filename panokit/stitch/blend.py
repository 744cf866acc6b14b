"""Views laid over one another: a weighted mean of all, or the nearest view with soft bands.

Everything happens on the sphere: columns wrap, and rows beyond a pole go on at the opposite
azimuth, so that neither +-180 degrees nor a pole is an edge.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import View
from panokit.sphere.extension import pad_sphere
from panokit.stitch.layout import Patch, focal_px, padded_patch, scaled, view_patches

# Weighted pixels of one view, made when they are needed: (h, w, 4), color times weight and weight.
Weighted = Callable[[int], NDArray[np.float32]]

_LEAST_WEIGHT = 1e-9
_EDGE_WEIGHT = 1e-4
_FINER = 1.4
_MOST_BANDS = 6
_MASK_FADE = 0.06


def blend_feather(
    weighted: Weighted, views: Sequence[View], width_px: int
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """The weighted mean of all views that show a direction.

    Args:
        weighted: Pixels of the view with this number, multiplied by their weights.
        views: Their poses and sizes.
        width_px: Of the panorama.

    Returns:
        (W / 2, W, 3) float32 and (W / 2, W) bool, False where no view shows anything.
    """
    total = np.zeros((width_px // 2, width_px, 4), np.float32)
    for number, view in enumerate(views):
        picture, fitted = _fitted(weighted(number), view, width_px)
        for patch in view_patches(fitted, width_px):
            warped = np.asarray(
                cv2.remap(picture, patch.column, patch.row, cv2.INTER_LINEAR), np.float32
            )
            _add(total[patch.top : patch.top + len(warped)], patch.left, warped)
    return _normalized(total)


def blend_bands(
    weighted: Weighted, views: Sequence[View], width_px: int
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Each direction from the view that sees it best, with seams as wide as the detail is.

    Coarse differences fade over many pixels and fine detail over few (Burt and Adelson 1983,
    "A multiresolution spline with application to image mosaics"), on square roots of light,
    so that the edge of a sun does not ring over the shadow beside it. Arguments and result as
    of `blend_feather`.
    """
    bands = _number_of_bands(width_px)
    block = 1 << bands
    best = np.full((width_px // 2, width_px), _LEAST_WEIGHT, np.float32)
    owner = np.full(best.shape, -1, np.int16)
    warped = []
    for number, view in enumerate(views):
        picture, fitted = _fitted(weighted(number), view, width_px)
        patch = padded_patch(fitted, width_px, block)
        share = np.asarray(
            cv2.remap(picture[..., 3], patch.column, patch.row, cv2.INTER_LINEAR), np.float32
        )
        color = cv2.remap(
            _filled(picture), patch.column, patch.row, cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REPLICATE,
        )  # fmt: skip
        warped.append((patch, color))
        _claim(best, owner, patch, share, number)
    levels = [
        np.zeros((width_px // 2 >> level, width_px >> level, 4), np.float32)
        for level in range(bands + 1)
    ]
    extended = pad_sphere(owner, block)
    for number, (patch, color) in enumerate(warped):
        mask = _cut(extended, patch, block, width_px) == number
        _add_bands(levels, patch, np.sqrt(np.maximum(color, 0)), mask.astype(np.float32), block)
    return np.square(np.maximum(_collapsed(levels), 0)), owner >= 0


@lru_cache(maxsize=8)
def view_weights(
    width_px: int, height_px: int, masked_px: tuple[tuple[int, int, int, int], ...]
) -> NDArray[np.float32]:
    """How much each pixel of a view counts, (h, w): 1 in the center, near 0 at the edges.

    The product of two tents, squared; 0 in masked rectangles, and fading toward them.
    """
    x = 1 - np.abs((np.arange(width_px) + 0.5) / width_px * 2 - 1)
    y = 1 - np.abs((np.arange(height_px) + 0.5) / height_px * 2 - 1)
    weights = (np.square(np.outer(y, x)) + _EDGE_WEIGHT).astype(np.float32)
    if masked_px:
        free = np.ones((height_px, width_px), np.uint8)
        for left, top, right, bottom in masked_px:
            free[max(top, 0) : max(bottom, 0), max(left, 0) : max(right, 0)] = 0
        away = cv2.distanceTransform(free, cv2.DIST_L2, 3)
        weights *= np.square(np.clip(away / (_MASK_FADE * width_px), 0, 1))
    weights.flags.writeable = False
    return weights


def _fitted(
    picture: NDArray[np.float32], view: View, width_px: int
) -> tuple[NDArray[np.float32], View]:
    """The view made smaller where it is much finer than the panorama, against aliasing."""
    finer = focal_px(view) * 2 * np.pi / width_px
    if finer < _FINER:
        return picture, view
    width = max(2, round(view.width_px / finer))
    height = max(2, round(view.height_px / finer))
    smaller = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(smaller, np.float32), scaled(view, width, height)


def _add(rows: NDArray[np.float32], left: int, values: NDArray[np.float32]) -> None:
    """Add values to rows of the panorama from a column on; columns wrap."""
    start, width = 0, rows.shape[1]
    while start < values.shape[1]:
        column = (left + start) % width
        count = min(width - column, values.shape[1] - start)
        part = rows[:, column : column + count]
        np.add(part, values[:, start : start + count], out=part)
        start += count


def _normalized(
    total: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    weight = total[..., 3]
    valid = weight > _LEAST_WEIGHT
    inverse = np.where(valid, 1 / np.maximum(weight, _LEAST_WEIGHT), 0).astype(np.float32)
    color = np.empty((*weight.shape, 3), np.float32)
    for channel in range(3):
        np.multiply(total[..., channel], inverse, out=color[..., channel])
    return color, valid


def _filled(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """Colors without weights; where there is no weight, those from around."""
    color, valid = _normalized(picture)
    if valid.all():
        return color
    reach = 0
    around = picture.copy()
    while not valid.all() and reach < 8:
        around = np.asarray(cv2.blur(around, (15, 15)), np.float32)
        near, near_valid = _normalized(around)
        fresh = near_valid & ~valid
        color[fresh] = near[fresh]
        valid |= fresh
        reach += 1
    return color


def _number_of_bands(width_px: int) -> int:
    """Halvings that keep whole pixels, at most six."""
    height, bands = width_px // 2, 0
    while bands < _MOST_BANDS and height % 2 == 0 and height > 16:
        height, bands = height // 2, bands + 1
    return bands


def _claim(
    best: NDArray[np.float32],
    owner: NDArray[np.int16],
    patch: Patch,
    share: NDArray[np.float32],
    number: int,
) -> None:
    height, width = best.shape
    first, last = max(patch.top, 0), min(patch.top + len(share), height)
    columns = (patch.left + np.arange(min(share.shape[1], width))) % width
    rows = np.arange(first, last)
    inner = share[first - patch.top : last - patch.top, : len(columns)]
    where = np.ix_(rows, columns)
    wins = inner > best[where]
    best[where] = np.where(wins, inner, best[where])
    owner[where] = np.where(wins, np.int16(number), owner[where])


def _cut(extended: NDArray[np.int16], patch: Patch, block: int, width_px: int) -> NDArray[np.int16]:
    """What a panorama with a border of `block` shows in a patch."""
    height, width = patch.column.shape
    columns = (patch.left + np.arange(width)) % width_px + block
    rows = np.clip(np.arange(patch.top, patch.top + height) + block, 0, len(extended) - 1)
    return extended[np.ix_(rows, columns)]


def _add_bands(
    levels: list[NDArray[np.float32]],
    patch: Patch,
    color: NDArray[np.float32],
    mask: NDArray[np.float32],
    block: int,
) -> None:
    """Add the bands of one view, each with the mask at its resolution."""
    for level, total in enumerate(levels):
        if level < len(levels) - 1:
            smaller = _halved(color)
            band = color - _doubled(smaller)
        else:
            smaller, band = color, color
        values = np.dstack([band * mask[..., None], mask])
        top, left = patch.top >> level, patch.left >> level
        first, last = max(top, 0), min(top + len(values), len(total))
        # A patch around the whole circle repeats columns in its border; they count once.
        width = total.shape[1]
        if values.shape[1] > width:
            border = block >> level
            values, left = values[:, border : border + width], left + border
        _add(total[first:last], left % width, values[first - top : last - top])
        if level < len(levels) - 1:
            color, mask = smaller, _halved(mask)


def _halved(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    height, width = picture.shape[:2]
    soft = cv2.GaussianBlur(picture, (3, 3), 0)
    size = (width // 2, height // 2)
    return np.asarray(cv2.resize(soft, size, interpolation=cv2.INTER_AREA), np.float32)


def _doubled(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    height, width = picture.shape[:2]
    size = (2 * width, 2 * height)
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_LINEAR), np.float32)


def _collapsed(levels: list[NDArray[np.float32]]) -> NDArray[np.float32]:
    """The sum of the bands; each is made larger with what lies beyond the seam and the poles."""
    result, _ = _normalized(levels[-1])
    for level in reversed(levels[:-1]):
        band, _ = _normalized(level)
        result = band + _doubled(pad_sphere(result, 1))[2:-2, 2:-2]
    return result

"""What each shift of a picture would put into each pixel of a hole, and what that costs."""

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.inpaint.labeling import Copies, visible

# How much of the slow changes of light counts when copies are compared: they are evened out
# afterwards.
_SLOW_SHARE = 0.3
_SLOW_PX = 5
_SOFT_PX = 1.5
_SOFT_SHARE = 0.7
_ROUGHNESS_SHARE = 1.0
# In gray levels, for each pixel of a seam.
_SEAM = 2.0
_LINES_SHARE = 0.9
_GUIDE_SHARE = 0.1


def make_features(coarse: NDArray[np.float32], hole: NDArray[np.bool_]) -> NDArray[np.float32]:
    """What copies should agree in, (N, N, 7) float32: color, edges, and how rough the ground is.

    Slow changes of light count less than the rest, and so does the finest grain.

    Args:
        coarse: (N, N, 3) float32, in gray levels, a membrane in the hole.
        hole: (N, N) bool.
    """
    slow = cv2.GaussianBlur(coarse, (0, 0), _SLOW_PX, borderType=cv2.BORDER_REFLECT)
    color = coarse - np.float32(1 - _SLOW_SHARE) * slow
    # Beside the hole means are taken over what is known.
    share = _soft((~hole).astype(np.float32), _SOFT_PX)
    soft = _soft(color * ~hole[..., None], _SOFT_PX) / np.maximum(share, 1e-3)[..., None]
    fine = (color - soft).mean(axis=-1) * ~hole
    rough = np.sqrt(
        _soft(fine * fine, 2 * _SOFT_PX)
        / np.maximum(_soft((~hole).astype(np.float32), 2 * _SOFT_PX), 1e-3)
    )
    third = np.float32(1 / np.sqrt(3))
    return np.dstack([third * color, _SOFT_SHARE * third * soft, _ROUGHNESS_SHARE * rough]).astype(
        np.float32
    )


def fine_features(features: NDArray[np.float32]) -> NDArray[np.float32]:
    """Of features the color without its slow changes, (N, N, 3): joints, cracks and grain."""
    color = features[..., :3]
    return np.asarray(color - np.float32(_LINES_SHARE) * _soft(color, _SLOW_PX), np.float32)


def _soft(values: NDArray[np.float32], reach_px: float) -> NDArray[np.float32]:
    return np.asarray(
        cv2.GaussianBlur(values, (0, 0), reach_px, borderType=cv2.BORDER_REFLECT), np.float32
    )


def make_copies(
    features: NDArray[np.float32],
    known: NDArray[np.bool_],
    source: NDArray[np.bool_],
    odd: NDArray[np.float32],
    number: NDArray[np.intp],
    offsets: list[tuple[int, int]],
) -> Copies:
    """The copies of every shift for every pixel of the hole.

    Args:
        features: (H, W, C) float32.
        known: (H, W) bool.
        source: (H, W) bool, what may be copied.
        odd: (H, W) float32, what copying a pixel costs.
        number: (H, W) int, of the hole's pixels; -1 elsewhere.
        offsets: The shifts, in rows and columns.
    """
    row, column = np.nonzero(number >= 0)
    values = np.zeros((len(offsets), len(row), features.shape[2]), np.float32)
    costs = np.full((len(offsets), len(row)), np.inf, np.float32)
    beside = [_within(row + d, column + r, known) for d, r in ((0, 1), (0, -1), (1, 0), (-1, 0))]
    steps = [
        (np.flatnonzero(known[place] & inside), d, r)
        for (place, inside), (d, r) in zip(beside, ((0, 1), (0, -1), (1, 0), (-1, 0)), strict=True)
    ]
    noise = _noise(features, known, number >= 0, offsets)
    for label, (down, right) in enumerate(offsets):
        place, inside = _within(row + down, column + right, known)
        values[label] = features[place]
        cost = odd[place]
        for at, step_down, step_right in steps:
            # Next to what is known a copy should look like what it lay next to.
            own = features[row[at] + step_down, column[at] + step_right]
            there, _ = _within(row[at] + down + step_down, column[at] + right + step_right, known)
            cost[at] += 2 * visible(own - features[there], noise)
        usable = inside & source[place]
        costs[label, usable] = cost[usable]
    return Copies(number=number, values=values, costs=costs, seam=_SEAM, noise=noise)


def follow(
    copies: Copies,
    coarse: NDArray[np.float32],
    guide: NDArray[np.float32],
    offsets: list[tuple[int, int]],
) -> None:
    """Make copies cost, in place, by how far their color is from a smaller view's filling."""
    size = len(coarse)
    reach = size / len(guide) / 2
    soft = cv2.GaussianBlur(coarse, (0, 0), reach, borderType=cv2.BORDER_REFLECT)
    wanted = cv2.resize(guide, (size, size), interpolation=cv2.INTER_LINEAR)
    row, column = np.nonzero(copies.number >= 0)
    for label, (down, right) in enumerate(offsets):
        place, _ = _within(row + down, column + right, copies.number)
        difference = (soft[place] - wanted[row, column]) / np.float32(np.sqrt(3))
        copies.costs[label] += _GUIDE_SHARE * visible(difference, copies.noise)


def _noise(
    features: NDArray[np.float32],
    known: NDArray[np.bool_],
    hole: NDArray[np.bool_],
    offsets: list[tuple[int, int]],
) -> float:
    """How much places that fit differ even so: over the best shifts, the median."""
    ring = cv2.dilate(hole.astype(np.uint8), np.ones((9, 9), np.uint8)) > 0
    row, column = np.nonzero(ring & known)
    medians = []
    for down, right in offsets:
        place, inside = _within(row + down, column + right, known)
        usable = inside & known[place]
        if usable.sum() > 0.5 * len(row):
            difference = np.linalg.norm(features[place] - features[row, column], axis=-1)
            medians.append(float(np.median(difference[usable])))
    return min(medians, default=4.0) + 0.5


def _within(
    row: NDArray[np.intp], column: NDArray[np.intp], picture: NDArray[np.generic]
) -> tuple[tuple[NDArray[np.intp], NDArray[np.intp]], NDArray[np.bool_]]:
    """Places moved into the picture, and which were in it."""
    height, width = picture.shape[:2]
    r, c = np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)
    return (r, c), (r == row) & (c == column)

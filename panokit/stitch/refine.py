"""Poses made better by what overlapping views show of the same directions.

Gauss-Newton over small rotations of all views at once: each direction should look the same in
every view that shows it. The scene is eliminated as in `photometry`, residuals are weighted
after Cauchy, and the poses given are a prior, so that views of empty sky stay where they are.
Coarse to fine on small copies, since a step is only right within a pixel or two.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import View
from panokit.frames import Rotation
from panokit.sphere import equirect_directions
from panokit.stitch.layout import focal_px, reposed
from panokit.stitch.overlaps import Thumbnail, radius_squared, read_at, visible
from panokit.stitch.photometry import Photometry

# (longer side of the small copies, width of the grid of directions, steps)
_STAGES = ((64, 192, 3), (160, 384, 4), (320, 640, 4))
_PRIOR_DEG = 1.0
_LEAST_NOISE = 0.004
_DISPLAY_POWER = 0.45


@dataclass(frozen=True, slots=True, eq=False)
class Refined:
    """Better poses.

    Attributes:
        views: With their new poses.
        moved_deg: (V,) by how many degrees each was turned.
        before: Typical difference of overlapping views, in display units, with the old poses.
        after: With the new ones.
    """

    views: tuple[View, ...]
    moved_deg: NDArray[np.float64]
    before: float
    after: float


def refine_poses(
    views: Sequence[View],
    stages: Iterable[tuple[Sequence[Thumbnail], int, int]],
    photometry: Photometry,
    *,
    least_deg: float = 0.0,
) -> Refined:
    """Turn each view a little so that overlaps agree.

    Args:
        views: With the poses as given.
        stages: Small copies of all views, width of the grid of directions, number of steps;
            coarse first.
        photometry: How each view was exposed; the copies are evened out with it.
        least_deg: Poses of which the first step moves half by less are right, and stay.
    """
    turns = [Rotation.identity()] * len(views)
    before = after = 0.0
    for index, (thumbnails, grid_px, steps) in enumerate(stages):
        directions = equirect_directions(grid_px, grid_px // 2).reshape(-1, 3)
        area = np.sqrt(np.maximum(1 - np.square(directions[:, 1]), 0)).astype(np.float32)
        slopes = [_slopes(small, photometry, i) for i, small in enumerate(thumbnails)]
        for step in range(steps):
            posed = [
                reposed(small.view, small.view.world_from_view @ turn)
                for small, turn in zip(thumbnails, turns, strict=True)
            ]
            moves, noise = _step(posed, slopes, directions, area)
            if index == 0 and step == 0:
                before = after = noise
                if np.rad2deg(np.median(np.linalg.norm(moves, axis=-1))) < least_deg:
                    return Refined(tuple(views), np.zeros(len(views)), before, after)
            after = noise
            turns = [turn @ _turn(move) for turn, move in zip(turns, moves, strict=True)]
    common = _common_turn(views, turns)
    poses = [
        common.inverse @ view.world_from_view @ turn
        for view, turn in zip(views, turns, strict=True)
    ]
    refined = tuple(reposed(view, pose) for view, pose in zip(views, poses, strict=True))
    moved = [
        (view.world_from_view.inverse @ pose).angle for view, pose in zip(views, poses, strict=True)
    ]
    return Refined(refined, np.rad2deg(moved), before, after)


def stage_sizes() -> tuple[tuple[int, int, int], ...]:
    """(longer side of the small copies, width of the grid, steps) of each stage."""
    return _STAGES


def _common_turn(views: Sequence[View], turns: Sequence[Rotation]) -> Rotation:
    """The turn of the whole scene, of which overlaps say nothing: the median of all views'.

    Left in, it would wander with the steps; a median, since a few poses may be far off.
    """
    vectors = []
    for view, turn in zip(views, turns, strict=True):
        pose = view.world_from_view
        m = (pose @ turn @ pose.inverse).matrix
        # Of small rotations the antisymmetric part is the vector.
        vectors.append(np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / 2)
    vector = np.median(vectors, axis=0)
    angle = float(np.linalg.norm(vector))
    return Rotation.about_axis(vector, angle) if angle else Rotation.identity()


def _slopes(small: Thumbnail, photometry: Photometry, number: int) -> NDArray[np.float32]:
    """(h, w, 4): evened-out brightness, its slopes along columns and rows, and usability."""
    height, width = small.linear.shape[:2]
    column, row = np.meshgrid(
        np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32)
    )
    passes = photometry.passes(radius_squared(small.view, column, row))
    even = small.linear / (photometry.gain[number].astype(np.float32) * passes[..., None])
    gray = np.power(np.maximum(even.mean(axis=-1), 0) + np.float32(1e-3), _DISPLAY_POWER)
    gray = gray.astype(np.float32)
    across = cv2.Scharr(gray, cv2.CV_32F, 1, 0, scale=1 / 32)
    down = cv2.Scharr(gray, cv2.CV_32F, 0, 1, scale=1 / 32)
    usable = cv2.erode(small.usable, np.ones((3, 3), np.uint8))
    return np.dstack([gray, across, down, usable])


def _step(
    views: Sequence[View],
    slopes: Sequence[NDArray[np.float32]],
    directions: NDArray[np.float32],
    area: NDArray[np.float32],
) -> tuple[NDArray[np.float64], float]:
    """Rotation vectors (V, 3) in each view's own frame, and the typical difference now."""
    count, places = len(views), len(directions)
    value = np.zeros((count, places), np.float32)
    weight = np.zeros((count, places), np.float32)
    jacobian = np.zeros((count, 3, places), np.float32)
    for number, (view, planes) in enumerate(zip(views, slopes, strict=True)):
        seen, column, row = visible(view, directions)
        read = read_at(planes, column, row)
        value[number, seen] = read[:, 0]
        weight[number, seen] = np.where(read[:, 3] > 0.98, area[seen], 0)
        jacobian[number][:, seen] = _by_rotation(view, directions[seen], read[:, 1], read[:, 2])
    weight[:, (weight > 0).sum(axis=0) < 2] = 0
    used = np.flatnonzero(weight.any(axis=0))
    if not len(used):
        return np.zeros((count, 3)), 0.0
    value, weight, jacobian = value[:, used], weight[:, used], jacobian[:, :, used]
    residual = value - _mean(value, weight)
    noise = max(float(np.median(np.abs(residual[weight > 0]))) / 0.6745, _LEAST_NOISE)
    weight = weight / (1 + np.square(residual / (2 * noise)))
    residual = value - _mean(value, weight)
    total = np.maximum(weight.sum(axis=0), 1e-12)
    rows = (jacobian * weight[:, None]).reshape(3 * count, -1)
    matrix = -((rows / total) @ rows.T).astype(np.float64)
    for number in range(count):
        own = slice(3 * number, 3 * number + 3)
        matrix[own, own] += rows[own] @ jacobian[number].T
    right = -(jacobian * (weight * residual)[:, None]).sum(axis=-1).reshape(-1).astype(np.float64)
    matrix[np.diag_indices(3 * count)] += np.square(noise / np.deg2rad(_PRIOR_DEG)) * 10
    return np.linalg.solve(matrix, right).reshape(count, 3), noise


def _by_rotation(
    view: View,
    directions: NDArray[np.float32],
    across: NDArray[np.float32],
    down: NDArray[np.float32],
) -> NDArray[np.float32]:
    """How the value read at directions (n, 3) changes as the view turns about its axes, (3, n).

    Turning the view by a small vector w moves a direction d, in the view's frame, by d x w.
    """
    local = directions @ view.world_from_view.matrix.astype(np.float32)
    x, y, z = local.T
    focal = np.float32(focal_px(view))
    # column = f x / -z, row = f y / z, up to constants.
    by_x, by_y = -across / z, down / z
    by_z = across * x / (z * z) - down * y / (z * z)
    gradient = np.stack([by_x, by_y, by_z]) * focal
    # (d x w) . g = w . (g x d)
    return np.stack(
        [
            gradient[1] * z - gradient[2] * y,
            gradient[2] * x - gradient[0] * z,
            gradient[0] * y - gradient[1] * x,
        ]
    )


def _turn(vector: NDArray[np.float64]) -> Rotation:
    angle = float(np.linalg.norm(vector))
    if angle == 0:
        return Rotation.identity()
    # A step that runs away is no step.
    return Rotation.about_axis(vector, min(angle, np.deg2rad(_PRIOR_DEG)))


def _mean(values: NDArray[np.float32], weight: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray(
        (weight * values).sum(axis=0) / np.maximum(weight.sum(axis=0), 1e-12), np.float32
    )

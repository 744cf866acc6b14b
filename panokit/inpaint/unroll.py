"""The picture unrolled around a point: the angle from it as rows, the azimuth as columns."""

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.sphere import equirect_directions, sample

ROW_DEG = 0.125
COLUMNS = 1440
_REACH_DEG = 70.0
_STRIP_PIXELS = 1 << 21


def unrolled(pixels: NDArray[np.uint8], center: NDArray[np.floating]) -> NDArray[np.float32]:
    """(rows, COLUMNS, 3) float32, 0 to 255; row r is (r + 0.5) * ROW_DEG from the center.

    Args:
        pixels: (H, W, 3) uint8, equirectangular.
        center: (3,), a direction.
    """
    width = 4 * COLUMNS
    if pixels.shape[1] > width:
        reduced = cv2.resize(pixels, (width, width // 2), interpolation=cv2.INTER_AREA)
        pixels = np.asarray(reduced, np.uint8)
    angle = np.deg2rad((np.arange(int(_REACH_DEG / ROW_DEG)) + 0.5) * ROW_DEG)[:, None, None]
    around = (np.arange(COLUMNS) / COLUMNS * 2 * np.pi)[None, :, None]
    axis, side, across = _axes(center)
    directions = np.cos(angle) * axis + np.sin(angle) * (
        np.cos(around) * side + np.sin(around) * across
    )
    return np.asarray(sample(pixels, directions.astype(np.float32)), np.float32)


def rolled_up(
    marked: NDArray[np.bool_], center: NDArray[np.floating], width_px: int, height_px: int
) -> NDArray[np.bool_]:
    """What is marked in an unrolled picture, as a mask of the panorama, (H, W) bool.

    Args:
        marked: (rows, COLUMNS) bool, the first rows of the unrolled picture.
        center: (3,), what it was unrolled around.
        width_px: Of the panorama.
        height_px: Of the panorama.
    """
    axis, side, across = (each.astype(np.float32) for each in _axes(center))
    mask = np.zeros((height_px, width_px), np.bool_)
    least = np.cos(np.deg2rad(len(marked) * ROW_DEG))
    step = max(1, _STRIP_PIXELS // width_px)
    for top in range(0, height_px, step):
        rows = slice(top, min(top + step, height_px))
        directions = equirect_directions(width_px, height_px, rows)
        cosine = directions @ axis
        near = cosine > least
        if not near.any():
            continue
        row = (np.rad2deg(np.arccos(np.clip(cosine[near], -1, 1))) / ROW_DEG).astype(np.intp)
        turn = np.arctan2(directions[near] @ across, directions[near] @ side) / (2 * np.pi)
        column = np.rint(turn * COLUMNS).astype(np.intp) % COLUMNS
        mask[rows][near] = marked[np.minimum(row, len(marked) - 1), column]
    return mask


def _axes(
    center: NDArray[np.floating],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The center, and the directions of azimuth 0 and 90 degrees around it, each (3,)."""
    axis = np.asarray(center, np.float64) / np.linalg.norm(center)
    side = np.cross(axis, (1.0, 0, 0) if abs(axis[0]) < 0.9 else (0, 0, 1.0))
    side /= np.linalg.norm(side)
    return axis, side, np.cross(axis, side)

"""The normals that a camera sees, as a square picture: the sphere's near half, from the front.

The pixel at (x, y) in [-1, 1]^2, x to the right and y up, stands for the normal (x, y, z) with
z = sqrt(1 - x^2 - y^2) toward the camera. Beyond the circle there is none.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError


@lru_cache(maxsize=8)
def hemisphere_normals(width_px: int) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """The normal of each cell and whether it has one; both read-only.

    Args:
        width_px: Width and height.

    Returns:
        (W, W, 3) float32 in the camera's frame (+X right, +Y up, +Z toward the camera), zero
        beyond the circle; (W, W) bool.
    """
    if width_px < 2:
        raise UsageError(f"A reflectance map is at least 2 pixels wide, not {width_px}.")
    across = (np.arange(width_px) + 0.5) * 2 / width_px - 1
    x, y = np.meshgrid(across, -across)
    square = x**2 + y**2
    inside = square < 1
    normals = np.stack([x, y, np.sqrt(np.maximum(1 - square, 0))], axis=-1)
    normals[~inside] = 0
    normals = normals.astype(np.float32)
    normals.setflags(write=False)
    inside.setflags(write=False)
    return normals, inside


def reach_in_cells(gate_deg: float, width_px: int) -> list[tuple[int, int]]:
    """Offsets (row, column) of all cells whose normal can lie within the gate of a pixel's.

    The pixel's normal lies somewhere in cell (0, 0). Two unit vectors are no nearer to each
    other than their x and y are, so a square of the chord's length holds all of them.
    """
    chord = 2 * np.sin(np.deg2rad(gate_deg) / 2) * width_px / 2
    most = int(np.floor(chord + 0.5))
    steps = range(-most, most + 1)
    # From anywhere in cell 0 to the center of a cell `n` away it is at least |n| - 1/2.
    return [
        (row, column)
        for row in steps
        for column in steps
        if np.hypot(max(abs(row) - 0.5, 0), max(abs(column) - 0.5, 0)) <= chord
    ]

"""How much of the sphere each pixel of an equirectangular picture covers."""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray


@lru_cache(maxsize=32)
def row_solid_angles(height_px: int, width_px: int | None = None) -> NDArray[np.float64]:
    """The exact solid angle, in steradians, of one pixel in each row.

    A row between polar angles a and b covers 2 pi (cos a - cos b), shared by W pixels.

    Returns:
        (H,) float64, read-only; times W it sums to 4 pi.
    """
    width_px = 2 * height_px if width_px is None else width_px
    edges = np.cos(np.linspace(0, np.pi, height_px + 1))
    solid_angles = (edges[:-1] - edges[1:]) * (2 * np.pi / width_px)
    solid_angles.setflags(write=False)
    return solid_angles


def pixel_solid_angles(height_px: int, width_px: int | None = None) -> NDArray[np.float64]:
    """The solid angle of each pixel, (H, W) float64, a read-only view; it sums to 4 pi."""
    width_px = 2 * height_px if width_px is None else width_px
    return np.broadcast_to(row_solid_angles(height_px, width_px)[:, None], (height_px, width_px))


def row_overlap_weights(source_rows: int, target_rows: int) -> NDArray[np.float64]:
    """How the rows of one picture mix into the rows of another so that energy is kept.

    Entry [t, s] is the solid angle that target row t and source row s share, over that of
    target row t, so each row of the matrix sums to 1.

    Returns:
        (target_rows, source_rows) float64.
    """
    source = -np.cos(np.linspace(0, np.pi, source_rows + 1))
    target = -np.cos(np.linspace(0, np.pi, target_rows + 1))
    top = np.maximum(source[None, :-1], target[:-1, None])
    bottom = np.minimum(source[None, 1:], target[1:, None])
    shared = np.maximum(bottom - top, 0.0)
    weights: NDArray[Any] = shared / shared.sum(axis=1, keepdims=True)
    return weights

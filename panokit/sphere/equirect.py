"""Equirectangular pixels <-> directions.

Pixel edges, not centers, lie on the borders: pixel column i has its center at
u = (i + 0.5) / W. Row 0 is the zenith, u = 0.5 looks along -Z, azimuth grows to the right.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.sphere.projection import Coordinates, Mask


@dataclass(frozen=True, slots=True, kw_only=True)
class Equirectangular:
    """The sphere unrolled: columns are azimuths, rows are elevations.

    Attributes:
        aspect: Width over height: 2, or 1 for the anamorphic 64x64 maps that networks
            predict. At any other the pixels are stretched, the directions right.
    """

    aspect: float = 2.0

    def directions(
        self, column: Coordinates, row: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Mask]:
        """See `Projection.directions`; columns wrap, beyond a pole lies the opposite azimuth."""
        azimuth = ((column + 0.5) / width_px - 0.5) * (2 * np.pi)
        elevation = (0.5 - (row + 0.5) / height_px) * np.pi
        horizontal = np.cos(elevation)
        parts = (horizontal * np.sin(azimuth), np.sin(elevation), -horizontal * np.cos(azimuth))
        directions = np.stack(np.broadcast_arrays(*parts), axis=-1)
        return directions, np.ones(directions.shape[:-1], bool)

    def pixel(
        self, directions: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Coordinates, Mask]:
        """See `Projection.pixel`; every direction is shown."""
        column, row = equirect_pixel(directions, width_px, height_px)
        return column, row, np.ones(np.shape(column), bool)

    def angle_per_pixel(self, width_px: int, height_px: int) -> float:
        """See `Projection.angle_per_pixel`; at the horizon, along the finer side."""
        return float(min(2 * np.pi / width_px, np.pi / height_px))


def equirect_directions(
    width_px: int, height_px: int, rows: slice | None = None
) -> NDArray[np.float32]:
    """The unit direction that each pixel's center looks at.

    Args:
        width_px: Of the picture.
        height_px: Of the picture.
        rows: Only these rows, to work on a big picture strip by strip.

    Returns:
        (rows, W, 3) float32, read-only.
    """
    if width_px < 1 or height_px < 1:
        raise UsageError(f"A picture has at least one pixel, not {width_px}x{height_px}.")
    if rows is None and width_px * height_px <= 1 << 21:
        return _whole_sphere(width_px, height_px)
    return _directions(width_px, height_px, rows or slice(None))


@lru_cache(maxsize=8)
def _whole_sphere(width_px: int, height_px: int) -> NDArray[np.float32]:
    directions = _directions(width_px, height_px, slice(None))
    directions.setflags(write=False)
    return directions


def _directions(width_px: int, height_px: int, rows: slice) -> NDArray[np.float32]:
    azimuth = ((np.arange(width_px) + 0.5) / width_px - 0.5) * (2 * np.pi)
    elevation = ((0.5 - (np.arange(height_px) + 0.5) / height_px) * np.pi)[rows]
    horizontal = np.cos(elevation)[:, None]
    directions = np.empty((len(elevation), width_px, 3), np.float32)
    directions[..., 0] = horizontal * np.sin(azimuth)
    directions[..., 1] = np.sin(elevation)[:, None]
    directions[..., 2] = -horizontal * np.cos(azimuth)
    return directions


def equirect_pixel(
    directions: NDArray[np.floating], width_px: int, height_px: int
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """Where directions (..., 3) of any length fall, as pixel coordinates with centers at integers.

    Returns:
        Column in [-0.5, W - 0.5] and row in [-0.5, H - 0.5], in the dtype of `directions`.
    """
    x, y, z = directions[..., 0], directions[..., 1], directions[..., 2]
    column = (np.arctan2(x, -z) * (0.5 / np.pi) + 0.5) * width_px - 0.5
    # atan2 against the horizontal length is accurate at the poles, where arcsin is not.
    row = (0.5 - np.arctan2(y, np.hypot(x, z)) / np.pi) * height_px - 0.5
    return column, row

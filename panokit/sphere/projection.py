"""What a projection is: pixels of a rectangle <-> directions of the sphere.

    Equirectangular   the sphere unrolled; also anamorphic, at any aspect
    Perspective       a pinhole camera
    Cubemap           six faces in one picture, in the layouts that tools use
    Radial            mirror ball, angular map, sky dome
    Octahedral        the sphere folded onto a square, plain or of equal area

All share one convention: pixel edges, not centers, lie on the borders of the picture, and
pixel coordinates have centers at integers. `PROJECTIONS` in `projections.py` names them all.
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError

Coordinates = NDArray[np.floating]
Mask = NDArray[np.bool_]


class Projection(Protocol):
    """One way to lay the sphere, or a part of it, on a rectangle."""

    @property
    def aspect(self) -> float:
        """Width over height of the whole picture."""

    def directions(
        self, column: Coordinates, row: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Mask]:
        """The unit direction at each pixel coordinate, and whether the picture shows it there.

        Args:
            column: (...), broadcast against `row`; pixel centers at integers.
            row: (...).
            width_px: Of the whole picture.
            height_px: Of the whole picture.

        Returns:
            (..., 3) directions in the dtype of the coordinates, and (...) bool. Outside the
            shown part, and outside the rectangle, directions go on as the sphere does.
        """

    def pixel(
        self, directions: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Coordinates, Mask]:
        """Column, row and whether the picture shows them, of directions (..., 3) of any length."""

    def angle_per_pixel(self, width_px: int, height_px: int) -> float:
        """How far apart, in radians, neighboring pixels look where they are the closest."""


def pixel_grid(
    projection: Projection, width_px: int, height_px: int, rows: slice | None = None
) -> tuple[NDArray[np.float32], Mask]:
    """The unit direction behind every pixel of a picture, and where the picture is valid.

    Args:
        projection: Of the picture.
        width_px: Of the picture.
        height_px: Of the picture.
        rows: Only these rows, to work on a big picture strip by strip.

    Returns:
        (rows, W, 3) float32 unit directions and (rows, W) bool.

    Raises:
        UsageError: If the picture has no pixels.
    """
    if width_px < 1 or height_px < 1:
        raise UsageError(f"A picture has at least one pixel, not {width_px}x{height_px}.")
    column = np.arange(width_px, dtype=np.float64)[None, :]
    row = np.arange(height_px, dtype=np.float64)[rows or slice(None)][:, None]
    directions, valid = projection.directions(column, row, width_px, height_px)
    return directions.astype(np.float32), valid


def centered(
    column: Coordinates, row: Coordinates, width_px: int, height_px: int
) -> tuple[Coordinates, Coordinates]:
    """Pixel coordinates as x to the right and y up, -1 to 1 between the edges of the picture."""
    return (column + 0.5) / width_px * 2 - 1, 1 - (row + 0.5) / height_px * 2


def uncentered(
    x: Coordinates, y: Coordinates, width_px: int, height_px: int
) -> tuple[Coordinates, Coordinates]:
    """The inverse of `centered`."""
    return (x + 1) / 2 * width_px - 0.5, (1 - y) / 2 * height_px - 0.5


def within(column: Coordinates, row: Coordinates, width_px: int, height_px: int) -> Mask:
    """Whether pixel coordinates lie between the edges of the picture."""
    # Directions are often float32: a beam through the very edge may round outward.
    slack = 1e-3
    inside: Mask = (
        (column >= -0.5 - slack)
        & (column <= width_px - 0.5 + slack)
        & (row >= -0.5 - slack)
        & (row <= height_px - 0.5 + slack)
    )
    return inside

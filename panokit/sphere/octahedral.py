"""The sphere folded onto a square: a picture without gaps and nearly without distortion.

The zenith is in the middle, the nadir in all four corners, the horizon a diamond between;
east is to the right, south to the bottom. Renderers store probes so.
"""

from dataclasses import dataclass

import numpy as np

from panokit.sphere.projection import Coordinates, Mask, centered, uncentered, within


@dataclass(frozen=True, slots=True, kw_only=True)
class Octahedral:
    """The octahedral map (Cigolle et al. 2014, "A Survey of Efficient Representations for
    Independent Unit Vectors").

    Attributes:
        equal_area: Every pixel covers the same solid angle (Clarberg 2008, "Fast Equal-Area
            Mapping of the (Hemi)Sphere using SIMD"), as pbrt-v4 wants its environment maps;
            pbrt's +Z is then our +Y.
    """  # noqa: D205

    equal_area: bool = False

    @property
    def aspect(self) -> float:
        """1: a square."""
        return 1.0

    def directions(
        self, column: Coordinates, row: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Mask]:
        """See `Projection.directions`; beyond an edge the other half of the same edge follows."""
        x, y = np.broadcast_arrays(*centered(column, row, width_px, height_px))
        x, y = _folded_back(x, y)
        south = -y
        upward = 1 - np.abs(x) - np.abs(south)
        # Outside the diamond lies the lower half: fold its corners in.
        east = np.where(upward < 0, (1 - np.abs(south)) * _sign(x), x)
        south = np.where(upward < 0, (1 - np.abs(x)) * _sign(south), south)
        if self.equal_area:
            directions = _equal_area_direction(east, south, upward)
        else:
            directions = np.stack([east, upward, south], axis=-1)
            directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
        return directions, np.ones(x.shape, bool)

    def pixel(
        self, directions: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Coordinates, Mask]:
        """See `Projection.pixel`."""
        length = np.linalg.norm(directions, axis=-1, keepdims=True)
        unit = directions / np.where(length > 0, length, 1)
        if self.equal_area:
            x, south = _equal_area_diamond(unit)
        else:
            whole = np.abs(unit).sum(axis=-1)
            whole = np.where(whole > 0, whole, 1)
            x, south = unit[..., 0] / whole, unit[..., 2] / whole
        below = unit[..., 1] < 0
        east = np.where(below, (1 - np.abs(south)) * _sign(x), x)
        south = np.where(below, (1 - np.abs(x)) * _sign(south), south)
        column, row = uncentered(east, -south, width_px, height_px)
        return column, row, within(column, row, width_px, height_px)

    def angle_per_pixel(self, width_px: int, height_px: int) -> float:
        """See `Projection.angle_per_pixel`: 4 pi over the pixels, as of equal areas."""
        return float(np.sqrt(4 * np.pi / (width_px * height_px)))


def _sign(values: Coordinates) -> Coordinates:
    # Not np.sign: zero belongs to one side, or the middle lines would fall into the nadir.
    return np.where(values < 0, -1.0, 1.0).astype(values.dtype)


def _folded_back(x: Coordinates, y: Coordinates) -> tuple[Coordinates, Coordinates]:
    """Coordinates beyond the square, up to its own width, as those inside that continue it."""
    over_x, over_y = np.abs(x) > 1, np.abs(y) > 1
    new_x = np.where(over_x, _sign(x) * (2 - np.abs(x)), x)
    new_y = np.where(over_y, _sign(y) * (2 - np.abs(y)), y)
    # Crossing one edge mirrors the other coordinate; crossing two, at a corner, mirrors both.
    return np.where(over_y, -new_x, new_x), np.where(over_x, -new_y, new_y)


def _equal_area_direction(
    east: Coordinates, south: Coordinates, upward: Coordinates
) -> Coordinates:
    radius = np.abs(east) + np.abs(south)
    turn = np.where(radius > 0, np.abs(south) / np.where(radius > 0, radius, 1), 0) * (np.pi / 2)
    height = 1 - radius**2
    across = radius * np.sqrt(np.maximum(2 - radius**2, 0))
    return np.stack(
        [
            across * np.cos(turn) * _sign(east),
            height * _sign(upward),
            across * np.sin(turn) * _sign(south),
        ],
        axis=-1,
    )


def _equal_area_diamond(unit: Coordinates) -> tuple[Coordinates, Coordinates]:
    # 1 - |y| loses all its digits near the poles; (x^2 + z^2) / (1 + |y|) does not.
    height = np.abs(unit[..., 1])
    radius = np.sqrt((unit[..., 0] ** 2 + unit[..., 2] ** 2) / (1 + height))
    turn = np.arctan2(np.abs(unit[..., 2]), np.abs(unit[..., 0])) / (np.pi / 2)
    south = radius * turn
    return (radius - south) * _sign(unit[..., 0]), south * _sign(unit[..., 2])

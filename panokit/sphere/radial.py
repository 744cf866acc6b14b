"""Pictures that show the sphere as a disc: mirror ball, angular map, sky dome.

In each the angle from one central direction grows with the distance from the middle of the
disc, by a law of its own; the corners of the picture show nothing.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from panokit.sphere.projection import Coordinates, Mask, centered, uncentered


class RadialLaw(StrEnum):
    """How the radius r of the disc, 0 to 1, and the angle t from its central direction agree.

    MIRROR is r = sin(t / 2): the reflection in a sphere seen from far away. EQUIDISTANT is
    r = t / t_max.
    """

    MIRROR = "mirror"
    EQUIDISTANT = "equidistant"


@dataclass(frozen=True, slots=True, kw_only=True)
class Radial:
    """A disc around one direction.

    Attributes:
        law: From radius to angle.
        center: The direction in the middle of the disc.
        right: The direction towards which the picture's right side looks.
        up: The direction towards which its top looks.
        angle_max: The angle at the rim, in radians.
    """

    law: RadialLaw
    center: tuple[float, float, float]
    right: tuple[float, float, float]
    up: tuple[float, float, float]
    angle_max: float = np.pi

    @property
    def aspect(self) -> float:
        """1: the disc touches all four sides."""
        return 1.0

    def directions(
        self, column: Coordinates, row: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Mask]:
        """See `Projection.directions`; beyond the rim the sphere goes on past the far point."""
        x, y = np.broadcast_arrays(*centered(column, row, width_px, height_px))
        radius = np.hypot(x, y)
        if self.law is RadialLaw.MIRROR:
            # Past the rim, where there is no ball, go back inward from the far point.
            folded = np.where(radius > 1, 2 - radius, radius)
            angle = 2 * np.arcsin(np.clip(folded, -1, 1))
            angle = np.where(radius > 1, 2 * np.pi - angle, angle)
        else:
            angle = radius * self.angle_max
        outward = np.sin(angle) / np.where(radius > 0, radius, 1)
        frame = np.array([self.right, self.up, self.center])
        local = np.stack([x * outward, y * outward, np.cos(angle)], axis=-1)
        return (local @ frame).astype(local.dtype), radius <= 1

    def pixel(
        self, directions: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Coordinates, Mask]:
        """See `Projection.pixel`."""
        frame = np.array([self.right, self.up, self.center], directions.dtype)
        local = directions @ frame.T
        across = np.hypot(local[..., 0], local[..., 1])
        angle = np.arctan2(across, local[..., 2])
        mirror = self.law is RadialLaw.MIRROR
        radius = np.sin(angle / 2) if mirror else angle / self.angle_max
        scale = radius / np.where(across > 0, across, 1)
        # The far point is the whole rim: take its right end. In the middle the radius is 0.
        x = np.where(across > 0, local[..., 0] * scale, radius)
        column, row = uncentered(x, local[..., 1] * scale, width_px, height_px)
        return column, row, angle <= self.angle_max + 1e-6

    def angle_per_pixel(self, width_px: int, height_px: int) -> float:
        """See `Projection.angle_per_pixel`; for the mirror, in the middle of the ball."""
        steepest = 2.0 if self.law is RadialLaw.MIRROR else self.angle_max
        return steepest * 2 / max(width_px, height_px)


# A chrome ball photographed by a far camera that looks along -Z: its middle shows the camera,
# its rim what is behind the ball. skylibs' "sphere" is this picture's mirror image.
MIRROR_BALL = Radial(law=RadialLaw.MIRROR, center=(0, 0, 1), right=(1, 0, 0), up=(0, 1, 0))

# Debevec's angular map ("Rendering Synthetic Objects into Real Scenes", 1998): the middle
# looks along -Z, the rim is the one direction +Z.
ANGULAR = Radial(law=RadialLaw.EQUIDISTANT, center=(0, 0, -1), right=(1, 0, 0), up=(0, 1, 0))

# The upper hemisphere as a map on the ground shows it: zenith in the middle, north at the
# top, east on the right. A camera that looks up sees its mirror image.
SKY_DOME = Radial(
    law=RadialLaw.EQUIDISTANT, center=(0, 1, 0), right=(1, 0, 0), up=(0, 0, -1),
    angle_max=np.pi / 2,
)  # fmt: skip

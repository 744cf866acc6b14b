"""Pinhole views: what a camera at the center of the sphere sees."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.sphere.projection import Coordinates, Mask, centered, pixel_grid, uncentered, within


@dataclass(frozen=True, slots=True, kw_only=True)
class Perspective:
    """A pinhole camera at the center of the sphere, with square pixels.

    Attributes:
        fov_deg: From the left edge to the right edge of the picture, more than 0 and less
            than 180.
        sphere_from_camera: The camera's pose; without it the camera looks along -Z.
        aspect: Width over height.
    """

    fov_deg: float
    sphere_from_camera: Rotation = field(default_factory=Rotation.identity)
    aspect: float = 1.0

    def __post_init__(self) -> None:
        if not 0 < self.fov_deg < 180:
            raise UsageError(
                f"A pinhole view is more than 0 and less than 180 wide, not {self.fov_deg}."
            )

    def directions(
        self, column: Coordinates, row: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Mask]:
        """See `Projection.directions`; beyond its edges the image plane goes on."""
        half = np.tan(np.deg2rad(self.fov_deg) / 2)
        x, y = centered(column, row, width_px, height_px)
        parts = (x * half, y * (half * height_px / width_px), np.array(-1.0))
        directions = np.stack(np.broadcast_arrays(*parts), axis=-1)
        directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
        inside = within(column, row, width_px, height_px)
        return self.sphere_from_camera.apply(directions), inside

    def pixel(
        self, directions: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Coordinates, Mask]:
        """See `Projection.pixel`; what is behind the camera is not shown."""
        local = self.sphere_from_camera.inverse.apply(directions)
        half = np.tan(np.deg2rad(self.fov_deg) / 2)
        depth = -local[..., 2]
        ahead = depth > 1e-6
        scale = np.where(ahead, 1 / np.where(ahead, depth * half, 1), 0)
        column, row = uncentered(
            local[..., 0] * scale, local[..., 1] * scale * width_px / height_px,
            width_px, height_px,
        )  # fmt: skip
        return column, row, ahead & within(column, row, width_px, height_px)

    def angle_per_pixel(self, width_px: int, height_px: int) -> float:
        """See `Projection.angle_per_pixel`; in the corners."""
        half = np.tan(np.deg2rad(self.fov_deg) / 2)
        corner = half**2 * (1 + (height_px / width_px) ** 2)
        return float(2 * half / width_px / (1 + corner))


def perspective_directions(
    width_px: int, height_px: int, fov_deg: float, sphere_from_camera: Rotation | None = None
) -> NDArray[np.float32]:
    """The unit direction behind each pixel of a pinhole picture; arguments as of `Perspective`.

    Returns:
        (height_px, width_px, 3) float32, in the sphere's frame.
    """
    pose = sphere_from_camera or Rotation.identity()
    view = Perspective(fov_deg=fov_deg, sphere_from_camera=pose)
    return pixel_grid(view, width_px, height_px)[0]


def perspective_pixel(
    directions: NDArray[np.floating],
    width_px: int,
    height_px: int,
    fov_deg: float,
    sphere_from_camera: Rotation | None = None,
) -> tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.bool_]]:
    """Where directions (..., 3) fall in a pinhole picture.

    Returns:
        Column and row with pixel centers at integers, and whether they are in the picture.
    """
    pose = sphere_from_camera or Rotation.identity()
    return Perspective(fov_deg=fov_deg, sphere_from_camera=pose).pixel(
        directions, width_px, height_px
    )

"""A bear of nine spheres on a matte floor, seen from the front and a little above.

Spheres, because whether one hides a light is one comparison; a bear, because a figure with a
head, arms and feet throws a shadow that tells where the light is.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Center and radius; the floor is y = 0.
SPHERES = np.array(
    [
        [0.0, 0.50, 0.0, 0.50],  # body
        [0.0, 1.22, 0.05, 0.36],  # head
        [-0.27, 1.52, 0.0, 0.14],  # ears
        [0.27, 1.52, 0.0, 0.14],
        [0.0, 1.13, 0.36, 0.15],  # snout
        [-0.47, 0.72, 0.20, 0.17],  # arms
        [0.47, 0.72, 0.20, 0.17],
        [-0.28, 0.17, 0.44, 0.17],  # feet
        [0.28, 0.17, 0.44, 0.17],
    ]
)
FLOOR_ALBEDO = 0.5
BEAR_ALBEDO = 0.8
CAMERA_PLACE = np.array([0.0, 3.2, 4.6])
CAMERA_TARGET = np.array([0.0, 0.6, 0.0])
FIELD_OF_VIEW_DEG = 32.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hits:
    """What the camera's rays meet.

    Attributes:
        place: (..., 3).
        normal: (..., 3), unit.
        sphere: (...) index into `SPHERES`, -1 for the floor.
    """

    place: Array
    normal: Array
    sphere: NDArray[np.intp]

    @property
    def albedo(self) -> Array:
        """(...) the share of light that is scattered back."""
        return np.where(self.sphere < 0, FLOOR_ALBEDO, BEAR_ALBEDO)


def see(size_px: int, rays: int) -> Hits:
    """Where rays x rays rays through each pixel end, arrays of shape (size, size, rays^2).

    The whole picture shows floor or bear: the horizon is above it.
    """
    forward = CAMERA_TARGET - CAMERA_PLACE
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right = right / np.linalg.norm(right)
    up = np.cross(right, forward)
    across = ((np.arange(size_px * rays) + 0.5) / (size_px * rays) * 2 - 1) * np.tan(
        np.deg2rad(FIELD_OF_VIEW_DEG) / 2
    )
    x, y = across[None, :, None], -across[:, None, None]
    direction = forward + x * right + y * up
    direction = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    pixels = direction.reshape(size_px, rays, size_px, rays, 3).swapaxes(1, 2)
    return _cast(pixels.reshape(size_px, size_px, rays**2, 3))


def _cast(direction: Array) -> Hits:
    nearest = -CAMERA_PLACE[1] / direction[..., 1]
    sphere = np.full(nearest.shape, -1, np.intp)
    for index, (*center, radius) in enumerate(SPHERES):
        toward = np.asarray(center) - CAMERA_PLACE
        along = direction @ toward
        inside = along**2 - (toward @ toward - radius**2)
        distance = along - np.sqrt(np.maximum(inside, 0))
        nearer = (inside > 0) & (distance < nearest)
        nearest = np.where(nearer, distance, nearest)
        sphere = np.where(nearer, index, sphere)
    place = CAMERA_PLACE + nearest[..., None] * direction
    normal = np.where(
        (sphere < 0)[..., None],
        np.array([0.0, 1.0, 0.0]),
        (place - SPHERES[sphere, :3]) / SPHERES[sphere, 3:],
    )
    return Hits(place=place, normal=normal, sphere=sphere)


def hidden(place: Array, own: NDArray[np.intp], directions: Array) -> NDArray[np.bool_]:
    """Which directions a sphere other than the point's own hides from each point.

    Args:
        place: (N, 3) points on the surfaces.
        own: (N,) the sphere each is on, -1 for the floor.
        directions: (M, 3) unit.

    Returns:
        (N, M), true where there is something in the way.
    """
    found = np.zeros((len(place), len(directions)), bool)
    lights = np.ascontiguousarray(directions.T, np.float32)
    for index, (*center, radius) in enumerate(SPHERES):
        toward = np.asarray(center) - place
        # The ray meets the sphere if it passes the center nearer than the radius, ahead of us.
        tangent = np.sqrt(np.maximum((toward**2).sum(axis=1) - radius**2, 0))
        tangent[own == index] = np.inf
        found |= toward.astype(np.float32) @ lights > tangent[:, None].astype(np.float32)
    return found

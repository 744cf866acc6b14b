"""Pinhole views: what a camera at the center of the sphere sees."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.sphere.sampling import sample


def perspective_directions(
    width_px: int, height_px: int, fov_deg: float, sphere_from_camera: Rotation | None = None
) -> NDArray[np.float32]:
    """The unit direction behind each pixel of a pinhole picture.

    Args:
        width_px: Of the picture.
        height_px: Of the picture; pixels are square.
        fov_deg: From the left edge to the right edge, more than 0 and less than 180.
        sphere_from_camera: The camera's pose; without it the camera looks along -Z.

    Returns:
        (height_px, width_px, 3) float32, in the sphere's frame.
    """
    if not 0 < fov_deg < 180:
        raise UsageError(f"A pinhole view is more than 0 and less than 180 wide, not {fov_deg}.")
    half = np.tan(np.deg2rad(fov_deg) / 2)
    x = ((np.arange(width_px) + 0.5) / width_px * 2 - 1) * half
    y = (1 - (np.arange(height_px) + 0.5) / height_px * 2) * half * height_px / width_px
    directions = np.empty((height_px, width_px, 3))
    directions[..., 0], directions[..., 1], directions[..., 2] = x[None, :], y[:, None], -1.0
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    turned = directions if sphere_from_camera is None else sphere_from_camera.apply(directions)
    return turned.astype(np.float32)


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
    if sphere_from_camera is not None:
        directions = sphere_from_camera.inverse.apply(directions)
    half = np.tan(np.deg2rad(fov_deg) / 2)
    depth = -directions[..., 2]
    ahead = depth > 1e-6
    scale = np.where(ahead, 1 / np.where(ahead, depth * half, 1), 0)
    column = (directions[..., 0] * scale + 1) / 2 * width_px - 0.5
    row = (1 - directions[..., 1] * scale * width_px / height_px) / 2 * height_px - 0.5
    inside = (
        ahead
        & (column >= -0.5)
        & (column <= width_px - 0.5)
        & (row >= -0.5)
        & (row <= height_px - 0.5)
    )
    return column, row, inside


def perspective_view(
    picture: NDArray[Any],
    width_px: int,
    height_px: int,
    fov_deg: float,
    sphere_from_camera: Rotation | None = None,
) -> NDArray[Any]:
    """The picture, (H, W) or (H, W, C) uint8 or float32, as a pinhole camera sees it."""
    return sample(picture, perspective_directions(width_px, height_px, fov_deg, sphere_from_camera))

"""Directions spread evenly over the sphere, on which losses compare irradiance."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from panokit.sphere import equirect_directions, row_solid_angles

# On how many the losses compare irradiance.
NORMALS = 64


@lru_cache(maxsize=4)
def sphere_normals(count: int) -> NDArray[np.float32]:
    """`count` unit vectors on a Fibonacci spiral, (count, 3) float32, read-only.

    Swinbank and Purser 2006, "Fibonacci grids: a novel approach to global modelling".
    """
    place = np.arange(count) + 0.5
    height = 1 - 2 * place / count
    radius = np.sqrt(1 - height**2)
    angle = np.pi * (3 - np.sqrt(5)) * place
    normals = np.stack([radius * np.cos(angle), height, radius * np.sin(angle)], axis=1)
    normals = normals.astype(np.float32)
    normals.setflags(write=False)
    return normals


def irradiance_matrix(width_px: int, count: int) -> NDArray[np.float32]:
    """The matrix that takes a grid's luminance, flattened, to irradiance, light vector, energy.

    Returns:
        (count + 4, H * W) float32: `count` rows of irradiance, three of the light vector and
        one of the energy.
    """
    height_px = width_px // 2
    directions = equirect_directions(width_px, height_px).reshape(-1, 3)
    area = np.repeat(row_solid_angles(height_px, width_px), width_px)
    received = np.maximum(sphere_normals(count) @ directions.T, 0)
    rows = np.concatenate([received, directions.T, np.ones((1, len(directions)))])
    return (rows * area).astype(np.float32)

"""What the light of a map does to surfaces: energy, light vector, irradiance."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.sphere.equirect import equirect_directions
from panokit.sphere.solid_angle import row_overlap_weights, row_solid_angles


def energy(radiance: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The sum of radiance x solid angle over the sphere, per channel: the energy ledger's figure.

    Args:
        radiance: (H, W, C), equirectangular.

    Returns:
        (C,) float64, in the unit of radiance times steradian.
    """
    height, width = radiance.shape[:2]
    rows = radiance.sum(axis=1, dtype=np.float64)
    return np.asarray(row_solid_angles(height, width) @ rows)


def light_vector(radiance: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The sum of luminance x direction x solid angle: where the light comes from on the whole.

    Returns:
        (3,) float64; its length over the energy is 1 for one small source and 0 for a
        uniform sky.
    """
    height, width = radiance.shape[:2]
    weighted = luminance(radiance) * row_solid_angles(height, width)[:, None]
    directions = equirect_directions(width, height)
    return np.asarray(np.tensordot(weighted, directions, axes=([0, 1], [0, 1])), np.float64)


def irradiance(
    radiance: NDArray[np.floating[Any]], normals: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    """The light that surfaces facing `normals` receive: E(n) = sum of L max(0, n.d) dOmega.

    The map is first averaged to at most 128x64, which keeps its energy exactly and moves no
    source by more than a texel's half, 1.4 degrees.

    Args:
        radiance: (H, W, C), equirectangular.
        normals: (..., 3), unit length, in the map's frame.

    Returns:
        (..., C) float64.
    """
    small = _averaged(np.asarray(radiance), 128)
    height, width, channels = small.shape
    directions = equirect_directions(width, height).reshape(-1, 3).astype(np.float64)
    parcels = (small * row_solid_angles(height, width)[:, None, None]).reshape(-1, channels)
    normals = np.asarray(normals, np.float64)
    received = np.maximum(normals.reshape(-1, 3) @ directions.T, 0.0) @ parcels
    return np.asarray(received.reshape(*normals.shape[:-1], channels))


def irradiance_map(radiance: NDArray[np.floating[Any]], width_px: int = 64) -> NDArray[np.float32]:
    """Irradiance for every normal of a `width_px` x `width_px // 2` equirectangular grid.

    Returns:
        (width_px // 2, width_px, C) float32.
    """
    normals = equirect_directions(width_px, width_px // 2)
    return irradiance(radiance, normals).astype(np.float32)


def _averaged(radiance: NDArray[Any], width_px: int) -> NDArray[np.float64]:
    height, width, channels = radiance.shape
    if width <= width_px or width % width_px or height % (width_px // 2):
        return radiance.astype(np.float64)
    narrow = radiance.reshape(height, width_px, width // width_px, channels).mean(
        axis=2, dtype=np.float64
    )
    weights = row_overlap_weights(height, width_px // 2)
    return np.asarray(np.tensordot(weights, narrow, axes=(1, 0)))

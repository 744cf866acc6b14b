"""What the light of a map does to surfaces: energy, light vector, irradiance."""

from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.color.temperature import chromaticity
from panokit.errors import ImageError, UsageError
from panokit.sphere.equirect import equirect_directions
from panokit.sphere.solid_angle import row_solid_angles

# The texels that light is gathered in: 2.8 degrees wide.
_TEXELS = (64, 128)
# Normals x texels worked on at once: in the processor's cache, and too few to wake BLAS threads.
_CHUNK = 1 << 17


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


def mean_chromaticity(radiance: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The CIE 1931 (x, y) of a map's light as a whole, weighted by energy; NaN for a black map.

    Bright sources count by what they give, not by how many pixels they cover. Pass `energy`
    of the map to `color.color_temperature` for how warm that is.

    Returns:
        (2,) float64.
    """
    return chromaticity(energy(radiance))


def irradiance(
    radiance: NDArray[np.floating[Any]],
    normals: NDArray[np.floating[Any]],
    *,
    exact: bool = False,
) -> NDArray[np.float64]:
    """The light that surfaces facing `normals` receive: E(n) = sum of L max(0, n.d) dOmega.

    The light is first gathered into 128x64 texels, each with its vector, the integral of
    L d dOmega. Where a texel lies wholly in front of the surface it adds n . vector, which is
    exact wherever in it the light is; only texels that the surface's own horizon cuts are
    approximated, where the cosine is next to nothing.

    Args:
        radiance: (H, W, C), equirectangular.
        normals: (..., 3), unit length, in the map's frame.
        exact: Sum over every pixel instead, which takes a thousand times as long.

    Returns:
        (..., C) float64.

    Raises:
        ImageError: If the map has no channel axis or no pixels, is of integers or not finite.
        UsageError: If the normals' last axis is not 3.
    """
    radiance, normals = np.asarray(radiance), np.asarray(normals)
    check_radiance(radiance)
    if normals.shape[-1:] != (3,):
        raise UsageError(f"Normals have shape (..., 3), not {normals.shape}.")
    flat = normals.reshape(-1, 3)
    received = _summed(radiance, flat) if exact else _gathered_both_sides(radiance, flat)[0]
    return received.reshape(*normals.shape[:-1], radiance.shape[2])


def check_radiance(radiance: NDArray[Any]) -> None:
    """Check that an array can be a map of radiance: (H, W, C), with pixels, of floats.

    Raises:
        ImageError: If not, with what to do.
    """
    if radiance.ndim != 3 or not radiance.size:
        raise ImageError(
            f"Expected radiance of shape (H, W, C), got {radiance.shape}.", reason="wrong-channels"
        )
    if not np.issubdtype(radiance.dtype, np.floating):
        raise ImageError(
            f"Radiance is linear and of floats, not {radiance.dtype}. Decode display values "
            "with panokit.color.srgb_decode.",
            reason="wrong-dtype",
        )


def irradiance_map(radiance: NDArray[np.floating[Any]], width_px: int = 64) -> NDArray[np.float32]:
    """Irradiance for every normal of a `width_px` x `width_px // 2` equirectangular grid.

    Returns:
        (width_px // 2, width_px, C) float32.
    """
    if width_px < 2 or width_px % 2:
        raise UsageError(f"The width of the map must be even and at least 2, not {width_px}.")
    check_radiance(np.asarray(radiance))
    height = width_px // 2
    normals = equirect_directions(width_px, height)
    if height % 2:
        return irradiance(radiance, normals).astype(np.float32)
    # What is not in front of a normal is in front of its opposite: half the work does.
    above, below = _gathered_both_sides(radiance, normals[: height // 2].reshape(-1, 3))
    received = np.empty((height, width_px, radiance.shape[2]), np.float32)
    received[: height // 2] = above.reshape(height // 2, width_px, -1)
    opposite = below.reshape(height // 2, width_px, -1)[::-1]
    received[height // 2 :] = np.roll(opposite, height, axis=1)
    return received


def light_parcels(
    radiance: NDArray[np.floating[Any]], size: tuple[int, int] = _TEXELS
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The light of a map gathered into texels, without losing where in the texel it lies.

    Args:
        radiance: (H, W, C), equirectangular; each pixel is the mean over its area.
        size: Rows and columns of texels; fewer where the map has fewer.

    Returns:
        Energies (T, C) float32, the integral of L dOmega over each texel; and vectors (T, C, 3)
        float32, the integral of L d dOmega: over the energy, a vector that is shorter than 1 by
        how widely the texel's light is spread.
    """
    height, width, channels = radiance.shape
    rows, columns = min(size[0], height), min(size[1], width)
    strips = np.asarray(radiance, np.float32).reshape(height, width * channels)
    weights = _row_integrals(height, width)
    sums = np.empty((rows, 3, width * channels), np.float32)
    edges = np.arange(rows + 1) * height // rows
    for row, (top, bottom) in enumerate(pairwise(edges)):
        np.matmul(weights[:, top:bottom], strips[top:bottom], out=sums[row])
    plain, upward, level = sums.reshape(rows, 3, width, channels).swapaxes(0, 1)
    cosine, sine = _column_directions(width)
    starts = np.arange(columns) * width // columns
    parts = (
        plain,
        level * sine[:, None],
        upward,
        level * -cosine[:, None],
    )
    gathered = np.stack([_block_sums(part, starts) for part in parts], axis=-1)
    gathered = gathered.reshape(rows * columns, channels, 4)
    return gathered[..., 0], gathered[..., 1:]


def _gathered_both_sides(
    radiance: NDArray[Any], normals: NDArray[Any]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The irradiance of normals (N, 3) and of their opposites, (N, C) each."""
    _, vectors = light_parcels(radiance)
    channels = vectors.shape[1]
    toward = np.ascontiguousarray(vectors.sum(axis=1).T)
    moments = np.ascontiguousarray(vectors.reshape(len(vectors), -1))
    everything = moments.sum(axis=0, dtype=np.float64)
    if not np.isfinite(everything).all():
        raise ImageError(
            "The map holds values that are not finite. Replace them before lighting with it.",
            reason="not-finite",
        )
    front, back = np.empty((2, len(normals), channels))
    step = max(_CHUNK // len(vectors), 1)
    for start in range(0, len(normals), step):
        facing = np.asarray(normals[start : start + step], np.float32)
        ahead = facing @ toward
        np.greater(ahead, 0, out=ahead)
        from_front = (ahead @ moments).astype(np.float64)
        rest = everything - from_front
        shape = (len(facing), channels, 3)
        front[start : start + step] = np.einsum("nci,ni->nc", from_front.reshape(shape), facing)
        back[start : start + step] = -np.einsum("nci,ni->nc", rest.reshape(shape), facing)
    return np.maximum(front, 0.0), np.maximum(back, 0.0)


def _summed(radiance: NDArray[Any], normals: NDArray[Any]) -> NDArray[np.float64]:
    height, width, channels = radiance.shape
    solid_angles = row_solid_angles(height, width)
    received = np.zeros((len(normals), channels))
    step = max(_CHUNK // max(len(normals) * width, 1), 1)
    for top in range(0, height, step):
        rows = slice(top, min(top + step, height))
        directions = equirect_directions(width, height, rows).reshape(-1, 3).astype(np.float64)
        parcels = radiance[rows] * solid_angles[rows, None, None]
        cosines = np.maximum(normals.astype(np.float64) @ directions.T, 0.0)
        received += cosines @ parcels.reshape(-1, channels)
    return received


def _block_sums(
    values: NDArray[np.float32], starts: NDArray[np.integer[Any]]
) -> NDArray[np.float32]:
    """Sums of (R, W, C) over blocks of columns that begin at `starts`."""
    rows, width, channels = values.shape
    if width % len(starts):
        return np.add.reduceat(values, starts, axis=1)
    block = width // len(starts)
    # As a product this is several times as fast as a sum along an inner axis.
    ones = np.tile(np.eye(channels, dtype=np.float32), (block, 1))
    flat = np.ascontiguousarray(values).reshape(-1, block * channels)
    return (flat @ ones).reshape(rows, len(starts), channels)


@lru_cache(maxsize=8)
def _row_integrals(height: int, width: int) -> NDArray[np.float32]:
    """The integrals of 1, sin e and cos e over a pixel of each row, (3, H).

    The last is along the azimuth of the pixel's middle, to which the others are symmetric.
    """
    edge = (0.5 - np.arange(height + 1) / height) * np.pi
    angle = 2 * np.pi / width
    upward = -np.diff(np.sin(edge) ** 2) / 2 * angle
    level = -np.diff(edge + np.sin(edge) * np.cos(edge)) / 2 * (2 * np.sin(angle / 2))
    return np.stack([row_solid_angles(height, width), upward, level]).astype(np.float32)


@lru_cache(maxsize=8)
def _column_directions(width: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    azimuth = ((np.arange(width) + 0.5) / width - 0.5) * (2 * np.pi)
    return np.cos(azimuth).astype(np.float32), np.sin(azimuth).astype(np.float32)

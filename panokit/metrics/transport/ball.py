"""Balls by circular convolution, and mirror balls by counting.

An orthographic camera sees a ball that is the same from every side of its axis: the light that
arrives `t` degrees from the axis and `p` degrees around it does to the pixel at angle `q` what
it would do at `p - q` to the pixel at angle 0. One table for one radius of the disc is
therefore enough, and turning it is a circular convolution.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from panokit.errors import UsageError
from panokit.metrics.transport.grids import AROUND, lattice, polar_weights, rings, row_parts
from panokit.metrics.transport.linear import Sparse, Step, Turning
from panokit.metrics.transport.reflectance import schlick
from panokit.metrics.transport.tables import ball_table

# Directions counted per pixel of a mirror ball: about 24^2 * 2 / pi.
_MIRROR_FINENESS = 24
_MIRROR_FINEST_PX = 4096
_MIRROR_BAND_ROWS = 64
_RIM_POINTS = 16
# A narrow lobe near the rim needs this many rays across the ball.
_ACROSS = 256
_LARGEST_PX = 1024


def ball_steps(scene: str, map_width_px: int, size_px: int) -> tuple[Step, ...]:
    """The chain of a rough ball: map, lattice, rings of light, rings of the ball, pixels."""
    table = ball_table(scene)
    _, radii, ring_count = table.shape
    return (
        lattice(map_width_px),
        rings(ring_count),
        Turning(table=table),
        disc(radii, size_px),
    )


def disc_alpha(size_px: int) -> NDArray[np.float32]:
    """The share of each pixel that the ball covers, (size, size) float32."""
    pixel, _, _, share = _points(size_px)
    return np.bincount(pixel, share, size_px**2).reshape(size_px, size_px).astype(np.float32)


@lru_cache(maxsize=8)
def disc(radii: int, size_px: int) -> Sparse:
    """From rings of the ball, even in the angle of the normal, to each pixel's mean."""
    pixel, x, y, share = _points(size_px)
    radius = np.hypot(x, y)
    tilt = np.arcsin(np.minimum(radius, 1))
    place = tilt / (np.pi / 2) * (radii - 1)
    points = polar_weights(place, np.arctan2(y, x), radii, pole_at_node=True)
    covered = np.bincount(pixel, share, size_px**2)
    weights = (share / covered[pixel]).astype(np.float32)
    shape = (size_px**2, len(pixel))
    gather = csr_array((weights, (pixel, np.arange(len(pixel)))), shape=shape)
    return Sparse(
        matrix=gather @ points, input_shape=(radii, AROUND), output_shape=(size_px, size_px)
    )


@lru_cache(maxsize=4)
def _points(
    size_px: int,
) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Points of the disc: their pixel, x to the right, y up, and the share of the pixel each has.

    The shading is smooth inside, where few are enough; a pixel at the rim has many, since its
    alpha is their count.
    """
    if not 4 <= size_px <= _LARGEST_PX:
        raise UsageError(f"A relit ball is 4 to {_LARGEST_PX} pixels wide, not {size_px}.")
    corner = np.abs(np.arange(size_px + 1) / size_px * 2 - 1)
    near, far = np.minimum(corner[:-1], corner[1:]), np.maximum(corner[:-1], corner[1:])
    inside = np.hypot(far[:, None], far) < 1
    rim = ~inside & (np.hypot(near[:, None], near) < 1)
    parts = []
    few = max(1, min(_RIM_POINTS, _ACROSS // size_px))
    for chosen, count in ((inside, few), (rim, _RIM_POINTS)):
        row, column = np.nonzero(chosen)
        offset = (np.arange(count) + 0.5) / count
        down, right = (part.ravel() for part in np.meshgrid(offset, offset, indexing="ij"))
        x = ((column[:, None] + right) / size_px * 2 - 1).ravel()
        y = (1 - (row[:, None] + down) / size_px * 2).ravel()
        pixel = np.repeat(row * size_px + column, count**2)
        kept = np.hypot(x, y) < 1
        share = np.full(int(kept.sum()), 1 / count**2)
        parts.append((pixel[kept], x[kept], y[kept], share))
    pixel, x, y, share = (np.concatenate(part) for part in zip(*parts, strict=True))
    return pixel, x, y, share


@lru_cache(maxsize=4)
def mirror(map_width_px: int, size_px: int, normal_reflectance: float) -> Sparse:
    """From a map's radiance to a mirror ball, every direction counted where it is seen.

    A mirror ball scatters evenly: the light of a solid angle w is seen on an area w / 4 of the
    disc of radius 1. So each pixel is the mean over directions that are evenly dense on the
    sphere, which treats the rim as well as the middle. Between texels the map is linear.
    """
    height = map_width_px // 2
    # Four parts show the slope between two texels, which only matters where a texel is large.
    slope = min(4, max(1, _MIRROR_FINEST_PX // map_width_px))
    parts = max(slope, -(-_MIRROR_FINENESS * size_px // map_width_px))
    _, polar, weight = row_parts(height, parts)
    azimuth = ((np.arange(map_width_px * parts) + 0.5) / (map_width_px * parts) - 0.5) * 2 * np.pi
    shown = disc_alpha(size_px).ravel() > 0
    total = csr_array((size_px**2, height * map_width_px), dtype=np.float32)
    counted = np.zeros(size_px**2)
    for start in range(0, len(polar), _MIRROR_BAND_ROWS):
        band = slice(start, start + _MIRROR_BAND_ROWS)
        pixel, share, facing = _seen_at(polar[band], azimuth, size_px)
        weights = np.repeat(weight[band], len(azimuth)) * share * shown[pixel]
        counted += np.bincount(pixel.ravel(), weights.ravel(), size_px**2)
        fresnel = normal_reflectance + (1 - normal_reflectance) * schlick(np.clip(facing, 0, 1))
        point = np.broadcast_to(np.arange(len(facing)), pixel.shape)
        some = weights > 0
        entries = (weights * fresnel)[some].astype(np.float32), (pixel[some], point[some])
        chosen = coo_array(entries, shape=(size_px**2, len(facing))).tocsr()
        rows = np.arange(start, start + len(polar[band]))
        total = total + chosen @ _linear_texels(rows, parts, map_width_px)
    scale = (1 / np.maximum(counted, 1e-12)).astype(np.float32)
    matrix = csr_array(total.multiply(scale[:, None]))
    return Sparse(
        matrix=matrix, input_shape=(height, map_width_px), output_shape=(size_px, size_px)
    )


def _seen_at(
    polar: NDArray[np.float64], azimuth: NDArray[np.float64], size_px: int
) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
    """Where the light of a grid of directions is seen.

    Each direction stands for a small solid angle, whose picture is taken as an upright box of
    the same spread: it may lie across two columns and two rows of pixels.

    Returns:
        (4, N) pixels, the (4, N) shares that they have of a direction, and (N,) normal . view.
    """
    place = _disc_place(polar, azimuth)
    down = _disc_place(polar + 1e-4, azimuth)
    right = _disc_place(polar, azimuth + 1e-4)
    steps = (polar[1] - polar[0]) / 1e-4, (azimuth[1] - azimuth[0]) / 1e-4
    halves = []
    for here, lower, beside in zip(place[:2], down[:2], right[:2], strict=True):
        spread = np.hypot((lower - here) * steps[0], (beside - here) * steps[1])
        center = (here + 1) / 2 * size_px
        width = np.clip(spread / 2 * size_px, 1e-6, 1)
        first = np.floor(center - width / 2)
        over = np.clip((center + width / 2 - first - 1) / width, 0, 1)
        nodes = np.clip(np.stack([first, first + 1]), 0, size_px - 1).astype(np.intp)
        halves.append((nodes, np.stack([1 - over, over])))
    (columns, across), (rows, along) = halves
    pixel = rows[:, None] * size_px + columns[None]
    share = along[:, None] * across[None]
    return pixel.reshape(4, -1), share.reshape(4, -1), place[2].ravel()


def _disc_place(
    polar: NDArray[np.float64], azimuth: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The normal that reflects each direction to the camera: right, down and toward it."""
    across = np.sin(polar)[:, None]
    toward = -across * np.cos(azimuth)
    # n = (d + view) / |d + view| with the view along +Z, so |d + view| = sqrt(2 (1 + z)).
    length = np.maximum(np.sqrt(np.maximum(2 * (1 + toward), 0)), 1e-9)
    right = across * np.sin(azimuth) / length
    down = -np.cos(polar)[:, None] / length
    return np.broadcast_to(right, length.shape), down, length / 2


def _linear_texels(rows: NDArray[np.intp], parts: int, width_px: int) -> csr_array:
    """Linear interpolation of a map at the cut texels of some rows, (points, texels)."""
    height = width_px // 2
    down = (rows + 0.5) / parts - 0.5
    right = (np.arange(width_px * parts) + 0.5) / parts - 0.5
    above, left = np.floor(down).astype(np.intp), np.floor(right).astype(np.intp)
    low, far = down - above, right - left
    two = np.arange(2)
    node_row = np.clip(above[:, None] + two, 0, height - 1)
    node_column = (left[:, None] + two) % width_px
    row_weight = np.stack([1 - low, low], axis=-1)
    column_weight = np.stack([1 - far, far], axis=-1)
    node = node_row[:, None, :, None] * width_px + node_column[None, :, None, :]
    weight = row_weight[:, None, :, None] * column_weight[None, :, None, :]
    points = len(rows) * len(right)
    pointers = np.arange(0, 4 * points + 1, 4)
    shape = (points, height * width_px)
    return csr_array(
        (weight.astype(np.float32).ravel(), node.astype(np.int32).ravel(), pointers), shape=shape
    )

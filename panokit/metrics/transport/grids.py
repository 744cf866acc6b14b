"""Where light is kept between a map and a picture, and how it is moved there.

Light is moved as energy: a texel's radiance x solid angle is shared among the nodes around it
with the weights of an interpolation. What a smooth kernel then sees is its own interpolated
value at the texel's true place, so a sun is not shifted to the nearest node (Lagrange's four
weights keep the moments of a kernel up to the third).
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from panokit.metrics.transport.linear import Separable, Sparse

Array = NDArray[np.float64]
LATTICE_WIDTH_PX = 512
LATTICE_HEIGHT_PX = LATTICE_WIDTH_PX // 2
AROUND = 256
# A map's texels are areas, not points: coarse ones are cut until they are this fine.
_FINEST_WIDTH_PX = 1024


def cubic_weights(place: Array) -> tuple[NDArray[np.intp], Array]:
    """Lagrange's weights of the four nodes around places on a grid of step 1.

    Returns:
        The first of the four nodes, (...), and the weights, (..., 4), which sum to 1.
    """
    below = np.floor(place)
    t = place - below
    weights = np.stack(
        [
            -t * (t - 1) * (t - 2) / 6,
            (t + 1) * (t - 1) * (t - 2) / 2,
            -(t + 1) * t * (t - 2) / 2,
            (t + 1) * t * (t - 1) / 6,
        ],
        axis=-1,
    )
    return below.astype(np.intp) - 1, weights


@lru_cache(maxsize=4)
def lattice(map_width_px: int) -> Separable:
    """From a map's radiance to energy (steradians x radiance) on the 512x256 lattice.

    Returns:
        (H, W, C) -> (512, 256, C), column by column.
    """
    height = map_width_px // 2
    parts = max(1, -(-_FINEST_WIDTH_PX // map_width_px))
    texel, polar, share = row_parts(height, parts)
    first, weights = cubic_weights(polar / np.pi * LATTICE_HEIGHT_PX - 0.5)
    # The first and last row stand for what lies beyond the pole: it is a third of a degree away.
    node = np.clip(first[:, None] + np.arange(4), 0, LATTICE_HEIGHT_PX - 1)
    rows = collected(node, texel, weights * share[:, None], (LATTICE_HEIGHT_PX, height))
    place = (np.arange(map_width_px * parts) + 0.5) / parts
    first, weights = cubic_weights(place / map_width_px * LATTICE_WIDTH_PX - 0.5)
    node = (first[:, None] + np.arange(4)) % LATTICE_WIDTH_PX
    texel = np.arange(map_width_px * parts) // parts
    columns = collected(node, texel, weights / parts, (LATTICE_WIDTH_PX, map_width_px))
    return Separable(rows=rows, columns=columns)


def row_parts(height_px: int, parts: int) -> tuple[NDArray[np.intp], Array, Array]:
    """Rows of a map cut into `parts`: which row, its polar angle, one texel's solid angle."""
    cut = height_px * parts
    edges = np.linspace(0, np.pi, cut + 1)
    share = (np.cos(edges[:-1]) - np.cos(edges[1:])) * (2 * np.pi / (2 * height_px))
    return np.arange(cut) // parts, (edges[:-1] + edges[1:]) / 2, share


def collected(
    node: NDArray[np.intp], texel: NDArray[np.intp], weights: Array, shape: tuple[int, int]
) -> csr_array:
    """A sparse matrix from (texels, k) nodes and weights, equal places added."""
    columns = np.broadcast_to(texel[:, None], node.shape)
    entries = coo_array((weights.ravel(), (node.ravel(), columns.ravel())), shape=shape)
    return entries.tocsr().astype(np.float32)


@lru_cache(maxsize=4)
def rings(count: int) -> Sparse:
    """From the lattice to rings about the camera's axis +Z: (512, 256, C) -> (count, 256, C).

    Ring k stands (k + 0.5) / count of a half turn away from +Z; node j of a ring j / 256 of a
    turn from +X toward +Y.
    """
    column, row = np.meshgrid(
        np.arange(LATTICE_WIDTH_PX), np.arange(LATTICE_HEIGHT_PX), indexing="ij"
    )
    azimuth = ((column + 0.5) / LATTICE_WIDTH_PX - 0.5) * (2 * np.pi)
    polar = (row + 0.5) / LATTICE_HEIGHT_PX * np.pi
    x, y, z = np.sin(polar) * np.sin(azimuth), np.cos(polar), -np.sin(polar) * np.cos(azimuth)
    ring = np.arccos(np.clip(z, -1, 1)) / np.pi * count - 0.5
    matrix = polar_weights(ring, np.arctan2(y, x), count, pole_at_node=False)
    return Sparse(
        matrix=matrix.T.tocsr(),
        input_shape=(LATTICE_WIDTH_PX, LATTICE_HEIGHT_PX),
        output_shape=(count, AROUND),
    )


def polar_weights(ring: Array, turn: Array, count: int, *, pole_at_node: bool) -> csr_array:
    """How values at points come from those at nodes on rings, (points, count * AROUND).

    Args:
        ring: (points,) place across the rings, 0 at the first.
        turn: (points,) angle about the axis, radians.
        count: Number of rings.
        pole_at_node: The first ring is the pole itself, and the last is an end; otherwise both
            poles lie half a step beyond.
    """
    ring, turn = ring.ravel(), turn.ravel()
    last = count - 1
    first, across = cubic_weights(ring)
    if pole_at_node:
        # One pole only; at the outer end the same cubic is read from the side.
        first, across = _held_inside(ring, first, across, count)
    beside, along = cubic_weights(turn / (2 * np.pi) * AROUND)
    node_ring = first[:, None] + np.arange(4)
    before = node_ring < 0
    after = node_ring > last
    # Beyond a pole the rings go on at the other side.
    mirrored = np.where(before, -node_ring if pole_at_node else -1 - node_ring, node_ring)
    mirrored = np.where(after, 2 * last + 1 - node_ring, mirrored)
    around = beside[:, None] + np.arange(4)
    opposite = (before | after)[:, :, None] * (AROUND // 2)
    node = mirrored[:, :, None] * AROUND + (around[:, None, :] + opposite) % AROUND
    weights = (across[:, :, None] * along[:, None, :]).astype(np.float32)
    pointers = np.arange(0, 16 * len(ring) + 1, 16)
    shape = (len(ring), count * AROUND)
    flat = node.reshape(-1).astype(np.int32)
    return csr_array((weights.reshape(-1), flat, pointers), shape=shape)


def _held_inside(
    ring: Array, first: NDArray[np.intp], across: Array, count: int
) -> tuple[NDArray[np.intp], Array]:
    over = first + 3 > count - 1
    t = ring[over] - (count - 4)
    nodes = np.arange(4.0)
    weights = np.ones((len(t), 4))
    for i in range(4):
        for j in range(4):
            if i != j:
                weights[:, i] *= (t - nodes[j]) / (nodes[i] - nodes[j])
    across[over] = weights
    first[over] = count - 4
    return first, across

"""Between panokit's pixels, which are cells, and grids whose pixels are nodes at the borders.

A tool whose first row lies *on* the zenith interpolates between nodes. Its light is the
integral of that interpolation, so the nodes are chosen to give back the light of the cells:
each node is the mean of the picture under its hat function. Both ways every weight is
positive, a constant stays one, and the energy is the same to rounding.
"""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

# Five points integrate hat times sine over a piece to 1e-12 already on eight rows.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)


def rows_from_pole_to_pole(radiance: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """The map (H, W, C) with its rows' centers at i * 180 / (H - 1) degrees from the zenith."""
    weights = _row_overlap(radiance.shape[0])
    return _mixed(weights, radiance, axis=0)


def rows_as_cells(nodes: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """The map (H, W, C) in panokit's rows, from one whose rows lie from pole to pole."""
    return _mixed(_row_overlap(nodes.shape[0]).T.tocsr(), nodes, axis=0)


def columns_from_seam_to_seam(radiance: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """The map with columns at i * 360 / (W - 1) degrees, so that the last repeats the first."""
    columns = _mixed(_column_overlap(radiance.shape[1]), radiance, axis=1)
    return np.concatenate([columns, columns[:, :1]], axis=1)


def columns_as_cells(nodes: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """The map in panokit's columns, from one whose last column repeats its first."""
    return _mixed(_column_overlap(nodes.shape[1]).T.tocsr(), nodes[:, :-1], axis=1)


def _mixed(weights: csr_array, pixels: NDArray[np.floating[Any]], axis: int) -> NDArray[np.float32]:
    """Each output row or column is the weighted mean of its inputs."""
    total = np.asarray(weights.sum(axis=1))
    mean = (weights.multiply(1 / total[:, None])).tocsr().astype(np.float32)
    moved = np.ascontiguousarray(np.moveaxis(np.asarray(pixels, np.float32), axis, 0))
    mixed = mean @ moved.reshape(len(moved), -1)
    return np.ascontiguousarray(np.moveaxis(mixed.reshape(-1, *moved.shape[1:]), 0, axis))


@lru_cache(maxsize=8)
def _row_overlap(height: int) -> csr_array:
    return _overlap(height, height - 1, np.pi, on_sphere=True)


@lru_cache(maxsize=8)
def _column_overlap(width: int) -> csr_array:
    return _overlap(width, width - 1, 2 * np.pi, on_sphere=False)


def _overlap(cells: int, gaps: int, span: float, *, on_sphere: bool) -> csr_array:
    """How much of each cell lies under each node's hat function, (nodes, cells).

    Args:
        cells: Equal cells over the span.
        gaps: Gaps between nodes; there is one node more on the sphere's rows, and on a circle
            the last node is the first.
        span: In radians.
        on_sphere: Whether the span runs from pole to pole, where rings shrink with the sine.
    """
    cell, gap = span / cells, span / gaps
    edges = np.union1d(np.arange(cells + 1) * cell, np.arange(gaps + 1) * gap)
    start, length = edges[:-1], np.diff(edges)
    middle = start + length / 2
    inside = start[:, None] + length[:, None] * (_POINTS + 1) / 2
    weight = length[:, None] * _WEIGHTS / 2 * (np.sin(inside) if on_sphere else 1.0)
    node = np.minimum((middle / gap).astype(int), gaps - 1)
    share = inside / gap - node[:, None]
    index = np.minimum((middle / cell).astype(int), cells - 1)
    nodes = gaps + 1 if on_sphere else gaps
    values = np.concatenate([(weight * (1 - share)).sum(axis=1), (weight * share).sum(axis=1)])
    rows = np.concatenate([node, (node + 1) % nodes])
    return csr_array((values, (rows, np.tile(index, 2))), shape=(nodes, cells))

"""Which triangle each pixel sees: a z-buffer in numpy, for a few thousand small triangles."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.scene import View
from panokit.errors import UsageError

Floats = NDArray[np.floating[Any]]
# Pairs of a triangle and a pixel worked on at once, so that memory stays small.
_PAIRS = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hits:
    """What the rays through a grid of points met.

    Attributes:
        face: (H, W) int32, the number of the triangle; -1 where there is none.
        weight: (H, W, 3) float64, of the triangle's corners, summing to one.
    """

    face: NDArray[np.int32]
    weight: NDArray[np.float64]

    def blend(self, corners: Floats) -> NDArray[np.float64]:
        """Values at the corners of triangles, (M, 3, C), where they were hit, (H, W, C).

        Where nothing was hit the result is that of the last triangle: mask it.
        """
        return np.einsum("hwk,hwkc->hwc", self.weight, corners[self.face])


def look(
    vertices: Floats, faces: NDArray[np.integer[Any]], view: View, oversampling: int = 1
) -> Hits:
    """What a camera sees, at `oversampling`^2 points in each pixel.

    Args:
        vertices: (N, 3) in the world, all in front of the camera.
        faces: (M, 3).
        view: The camera.
        oversampling: An odd number keeps one point at each pixel's center.

    Raises:
        UsageError: If part of the mesh lies behind the camera.
    """
    column, row, depth = view.project(np.asarray(vertices, np.float64))
    if depth.min() <= 0:
        raise UsageError("Part of the object lies behind the camera. Move the camera away.")
    points = np.stack([column, row], axis=1) * oversampling
    size = (view.height_px * oversampling, view.width_px * oversampling)
    return rasterize(points, 1 / depth, faces, size)


def rasterize(
    points: Floats, nearness: Floats, faces: NDArray[np.integer[Any]], size: tuple[int, int]
) -> Hits:
    """The nearest triangle at the center of each cell of a grid.

    Args:
        points: (N, 2), column and row of vertices on the grid, edges of cells at integers.
        nearness: (N,), the reciprocal of depth, which is linear on the picture; or any other
            figure that is larger for what hides the rest, with weights that are then not
            corrected for perspective only if it is one for all.
        faces: (M, 3).
        size: Rows and columns of the grid.
    """
    rows, columns = size
    corners = points[faces]
    low = np.clip(np.ceil(corners.min(axis=1) - 0.5), 0, [columns, rows]).astype(np.int64)
    high = np.clip(np.floor(corners.max(axis=1) - 0.5) + 1, 0, [columns, rows]).astype(np.int64)
    spans = np.maximum(high - low, 0)
    counts = spans[:, 0] * spans[:, 1]
    best = np.zeros(rows * columns)
    face = np.full(rows * columns, -1, np.int32)
    weight = np.zeros((rows * columns, 3))
    useful = np.flatnonzero(counts)
    batches = np.searchsorted(np.cumsum(counts[useful]), np.arange(0, counts.sum(), _PAIRS)[1:])
    for batch in np.split(useful, np.unique(batches)):
        if not len(batch):
            continue
        triangle = np.repeat(batch, counts[batch])
        first = np.repeat(np.cumsum(counts[batch]) - counts[batch], counts[batch])
        step = np.arange(len(triangle)) - first
        x = low[triangle, 0] + step % spans[triangle, 0]
        y = low[triangle, 1] + step // spans[triangle, 0]
        share = _shares(corners, triangle, x + 0.5, y + 0.5)
        inside = np.flatnonzero((share >= 0).all(axis=1))
        triangle, share = triangle[inside], share[inside]
        cell = y[inside] * columns + x[inside]
        near = (share * nearness[faces[triangle]]).sum(axis=1)
        # Of all that cover a cell the nearest comes last, and so it is what stays.
        order = np.lexsort((-triangle, near, cell))
        last = (
            order[np.append(np.flatnonzero(np.diff(cell[order])), len(order) - 1)]
            if len(order)
            else order
        )
        wins = last[near[last] > best[cell[last]]]
        best[cell[wins]], face[cell[wins]] = near[wins], triangle[wins]
        weight[cell[wins]] = share[wins] * nearness[faces[triangle[wins]]]
    weight /= np.maximum(weight.sum(axis=1, keepdims=True), 1e-300)
    return Hits(face=face.reshape(rows, columns), weight=weight.reshape(rows, columns, 3))


def _shares(
    corners: Floats, triangle: NDArray[np.integer[Any]], x: Floats, y: Floats
) -> NDArray[np.float64]:
    """Barycentric coordinates of points in the plane of the picture, (P, 3)."""
    a, b, c = (corners[:, k] for k in range(3))
    double = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    # A triangle seen edge on covers nothing.
    scale = np.divide(1.0, double, out=np.full(len(double), np.nan), where=abs(double) > 1e-12)
    shares = np.empty((len(triangle), 3))
    for k, (start, end) in enumerate(((b, c), (c, a))):
        line = np.stack(
            [
                -(end[:, 1] - start[:, 1]) * scale,
                (end[:, 0] - start[:, 0]) * scale,
                ((end[:, 1] - start[:, 1]) * start[:, 0] - (end[:, 0] - start[:, 0]) * start[:, 1])
                * scale,
            ]
        )
        shares[:, k] = line[0][triangle] * x + line[1][triangle] * y + line[2][triangle]
    shares[:, 2] = 1 - shares[:, 0] - shares[:, 1]
    return shares

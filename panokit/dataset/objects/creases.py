"""Where a surface is smooth and where it has a crease; normals of its vertices."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from panokit.dataset.scene import Mesh

Floats = NDArray[np.floating[Any]]
Integers = NDArray[np.integer[Any]]
# A chamfer turns by 45 degrees and is to look round; the edge of a plain box is not.
CREASE_DEG = 50.0


def weld(vertices: Floats, faces: Integers, step: float) -> tuple[Floats, Integers]:
    """Vertices closer than about `step` made one, and the faces that still are triangles.

    Returns:
        The vertices and the faces; which faces are left out is where two corners fell together.
    """
    keys = np.round(vertices / step).astype(np.int64)
    _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return vertices[first], place.reshape(-1)[faces]


def face_normals(vertices: Floats, faces: Integers) -> Floats:
    """(M, 3), as long as twice the area of each triangle."""
    a, b, c = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    return np.cross(b - a, c - a)


def split_creases(
    vertices: Floats, faces: Integers, crease_deg: float = CREASE_DEG
) -> tuple[Floats, Integers]:
    """The same triangles with vertices doubled wherever the surface has a crease.

    Two corners of one welded vertex stay together where an unbroken row of triangles, each
    bent by less than `crease_deg` against the next, leads from one to the other around it.

    Args:
        vertices: (N, 3), welded: a place that two triangles share is one vertex.
        faces: (M, 3).
        crease_deg: Sharper edges are creases.

    Returns:
        Vertices (K, 3) and faces (M, 3), in the order in which they were.
    """
    normals = face_normals(vertices, faces)
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    count = len(faces)
    # Corner 3 f + k is vertex k of face f; half-edge 3 f + k runs from corner k to the next.
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    ends = np.stack([np.minimum(start, end), np.maximum(start, end)], axis=1).astype(np.int64)
    edge = ends[:, 0] * (len(vertices) + 1) + ends[:, 1]
    order = np.argsort(edge, kind="stable")
    same = edge[order][1:] == edge[order][:-1]
    one, other = order[:-1][same], order[1:][same]
    smooth = np.einsum("ij,ij->i", normals[one // 3], normals[other // 3]) > np.cos(
        np.deg2rad(crease_deg)
    )
    one, other = one[smooth], other[smooth]
    # Both ends of a smooth edge are shared: of the same vertex, whichever way each edge runs.
    after_one, after_other = _next_corner(one), _next_corner(other)
    against = start[one] != start[other]
    pairs_a = np.concatenate([one, after_one])
    pairs_b = np.concatenate(
        [np.where(against, after_other, other), np.where(against, other, after_other)]
    )
    links = coo_array((np.ones(len(pairs_a), np.int8), (pairs_a, pairs_b)), (3 * count, 3 * count))
    _, group = connected_components(links, directed=False)
    _, first = np.unique(group, return_index=True)
    return vertices[start[first]], group.reshape(count, 3).astype(np.int32)


def _next_corner(corner: Integers) -> Integers:
    return corner - corner % 3 + (corner + 1) % 3


def corner_normals(mesh: Mesh) -> NDArray[np.float32]:
    """The shading normal at each corner of each triangle, (M, 3, 3) float32, unit length.

    On a smooth mesh it is the mean of the normals of all triangles that share the vertex,
    weighted by their area, so that large flat faces stay flat and chamfers look round.
    """
    vertices = np.asarray(mesh.vertices, np.float64)
    flat = face_normals(vertices, mesh.faces)
    corners = np.repeat(flat[:, None], 3, axis=1)
    if mesh.smooth:
        total = np.stack(
            [
                np.bincount(mesh.faces.reshape(-1), np.repeat(axis, 3), len(vertices))
                for axis in flat.T
            ],
            axis=1,
        )
        mean = total[mesh.faces]
        # Opposite triangles of a sheet cancel: there each keeps its own.
        usable = np.linalg.norm(mean, axis=2) > 1e-3 * np.linalg.norm(corners, axis=2)
        corners = np.where(usable[..., None], mean, corners)
    corners = corners / np.maximum(np.linalg.norm(corners, axis=2, keepdims=True), 1e-30)
    return corners.astype(np.float32)

"""Textures laid on by box projection: where each corner of a triangle lies in the picture."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.materials import TEXTURE_SIDE_M
from panokit.dataset.objects.creases import face_normals
from panokit.dataset.scene import Material, Mesh

# For a triangle that faces mostly along x, y or z: the axes that run along the picture.
_ALONG = np.array([[2, 1], [0, 2], [0, 1]])


def box_coordinates(mesh: Mesh) -> NDArray[np.float32]:
    """(M, 3, 2) float32, the place of each corner in a texture that repeats every 1.

    Each triangle gets its texture from the side it faces most, in coordinates that start at the
    middle of the object's bounding box.
    """
    low, high = mesh.bounds
    points = np.asarray(mesh.vertices, np.float64) - (low.astype(np.float64) + high) / 2
    facing = np.abs(face_normals(points, mesh.faces)).argmax(axis=1)
    corners = points[mesh.faces] / TEXTURE_SIDE_M
    along = _ALONG[facing][:, None, :]
    return np.take_along_axis(corners, along, axis=2).astype(np.float32)


def texture_at(material: Material, place: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """The albedo of a material at places (..., 2) of its texture, (..., 3) float32.

    Row 0 of the texture lies at v = 1, pixels are squares without interpolation.
    """
    if material.texture is None:
        color = np.asarray(material.base_color, np.float32)
        return np.broadcast_to(color, (*place.shape[:-1], 3)).copy()
    height, width = material.texture.shape[:2]
    column = np.floor(place[..., 0] % 1 * width).astype(int) % width
    row = np.floor((-place[..., 1]) % 1 * height).astype(int) % height
    return np.asarray(material.texture[row, column], np.float32)

"""Normals of a rough shape that stands in for an object: what a user can say with one choice."""

from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import Rotation

# A box is seen from a corner, a little from above.
_BOX = Rotation.about_axis((1, 0, 0), np.deg2rad(25)) @ Rotation.about_axis(
    (0, 1, 0), np.deg2rad(45)
)


class Primitive(StrEnum):
    """Shapes that fill the object's bounding rectangle."""

    SPHERE = "sphere"
    CYLINDER = "cylinder"
    BOX = "box"


def primitive_normals(
    mask: NDArray[np.bool_], shape: Primitive = Primitive.SPHERE
) -> NDArray[np.float32]:
    """The normals that the object would have if it were this shape.

    Args:
        mask: (H, W), the object's pixels.
        shape: A sphere or ellipsoid, an upright cylinder, or a box seen from a corner.

    Returns:
        (H, W, 3) float32 in the camera's frame, of unit length where `mask` is true, zero
        elsewhere.

    Raises:
        UsageError: If the mask is empty.
    """
    rows, columns = np.nonzero(mask)
    if len(rows) == 0:
        raise UsageError("The mask has no pixel; choose an object first.")
    x = _across(columns)
    y = -_across(rows)
    normals = {
        Primitive.SPHERE: _ellipsoid,
        Primitive.CYLINDER: _cylinder,
        Primitive.BOX: _box,
    }[Primitive(shape)](x, y)
    result = np.zeros((*mask.shape, 3), np.float32)
    result[rows, columns] = normals
    return result


def _across(places: NDArray[Any]) -> NDArray[np.float64]:
    """Places of pixels as -1 to 1 over their range."""
    first, last = int(places.min()), int(places.max())
    return np.asarray((places + 0.5 - first) * 2 / (last - first + 1) - 1)


def _ellipsoid(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    # The corners of the rectangle lie beyond the ellipse: they take the normal of its rim.
    length = np.maximum(np.hypot(x, y), 1.0)
    x, y = x / length, y / length
    return np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1)


def _cylinder(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack([x, 0 * y, np.sqrt(np.maximum(1 - x**2, 0))], axis=-1)


def _box(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """The face of a cube, seen from afar, that lies in front at each place."""
    axes = _BOX.matrix  # columns are the cube's own axes in the camera's frame
    half = np.abs(axes[:2]).sum(axis=1)
    place = np.stack([x * half[0], y * half[1]], axis=-1)
    facing = [axes[:, n] * (1.0 if axes[2, n] > 0 else -1.0) for n in range(3)]
    # On a face n . p = 1, so its plane is at z = (1 - n_xy . p_xy) / n_z, +Z toward the camera. A
    # convex body lies behind all its planes: it is seen on the one that is farthest back.
    height = np.stack([(1 - place @ n[:2]) / n[2] for n in facing], axis=-1)
    return np.asarray(np.stack(facing)[height.argmin(axis=-1)])

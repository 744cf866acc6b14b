"""Axes, rotations, and directions as azimuth and elevation.

panokit's frame is right-handed: +X right (east), +Y up, -Z forward (north). Azimuth grows
clockwise seen from above, like a compass: 0 is north (-Z), pi/2 is east (+X). Elevation is
the angle above the horizon. Angles are radians here; only records, TOML and the command line
use degrees, and then the name ends in `_deg`.

A rotation is always named `a_from_b`: it turns the coordinates of a direction in frame b into
its coordinates in frame a, so `a_from_c = a_from_b @ b_from_c`.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from panokit.errors import UsageError

FloatArray = NDArray[np.floating[Any]]


class Frame(StrEnum):
    """Which way the center column and the rows of a spherical picture look.

    WORLD is level with north at the center, LEVEL is level with an unknown heading, CAMERA
    is the frame of the camera as it stood, tilt included.
    """

    WORLD = "world"
    LEVEL = "level"
    CAMERA = "camera"


@dataclass(frozen=True, slots=True, eq=False)
class Rotation:
    """A proper rotation, as a 3x3 matrix with determinant 1.

    Attributes:
        matrix: (3, 3) float64, read-only; a direction d, as a column, becomes `matrix @ d`.
    """

    matrix: FloatArray

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, dtype=np.float64)
        if matrix.shape != (3, 3) or not np.all(np.isfinite(matrix)):
            raise UsageError(f"A rotation is a finite 3x3 matrix, not an array {matrix.shape}.")
        if not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-6) or np.linalg.det(matrix) < 0:
            raise UsageError("A rotation matrix is orthonormal with determinant 1; this is not.")
        matrix.setflags(write=False)
        object.__setattr__(self, "matrix", matrix)

    @classmethod
    def identity(cls) -> "Rotation":
        """The rotation that changes nothing."""
        return cls(np.eye(3))

    @classmethod
    def about_axis(cls, axis: ArrayLike, angle: float) -> "Rotation":
        """The right-handed rotation by `angle` radians about `axis` (Rodrigues' formula)."""
        unit = np.asarray(axis, dtype=np.float64)
        length = float(np.linalg.norm(unit))
        if unit.shape != (3,) or length == 0:
            raise UsageError("The axis of a rotation is three numbers that are not all zero.")
        x, y, z = unit / length
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return cls(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross))

    @classmethod
    def from_heading_pitch_roll(
        cls, heading: float, pitch: float = 0.0, roll: float = 0.0
    ) -> "Rotation":
        """The rotation `world_from_camera` of a camera with this pose, in radians.

        Heading is the compass direction of the camera's forward axis, clockwise from north;
        pitch is positive when the camera looks up; roll is positive when the camera leans to
        its right. Applied in the order of photo-sphere metadata: heading, then pitch, then
        roll, each about the axes that the one before left (GPano, "Pose" properties).
        """
        turn = cls.about_axis((0, 1, 0), -heading)
        nod = cls.about_axis((1, 0, 0), pitch)
        lean = cls.about_axis((0, 0, 1), -roll)
        return turn @ nod @ lean

    def heading_pitch_roll(self) -> tuple[float, float, float]:
        """The angles, in radians, that `from_heading_pitch_roll` would take for this rotation."""
        forward = -self.matrix[:, 2]
        pitch = float(np.arcsin(np.clip(forward[1], -1, 1)))
        if abs(forward[1]) > 1 - 1e-12:
            # Looking straight up or down: only heading and roll together are defined.
            return float(np.arctan2(self.matrix[2, 0], self.matrix[0, 0])), pitch, 0.0
        heading = float(np.arctan2(forward[0], -forward[2]))
        roll = float(np.arctan2(-self.matrix[1, 0], self.matrix[1, 1]))
        return heading, pitch, roll

    @property
    def inverse(self) -> "Rotation":
        """The rotation that undoes this one: `b_from_a` of `a_from_b`."""
        return Rotation(self.matrix.T)

    @property
    def angle(self) -> float:
        """By how many radians this rotation turns about its own axis, 0 to pi."""
        # atan2 keeps small angles that arccos of the trace would round to zero.
        m = self.matrix
        twice_axis = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
        return float(np.arctan2(np.linalg.norm(twice_axis), np.trace(m) - 1))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rotation) and np.array_equal(self.matrix, other.matrix)

    def __hash__(self) -> int:
        # Adding 0 makes -0 and 0, which are equal, hash alike.
        return hash((self.matrix + 0.0).tobytes())

    def __matmul__(self, other: "Rotation") -> "Rotation":
        return Rotation(self.matrix @ other.matrix)

    def apply(self, directions: FloatArray) -> FloatArray:
        """Rotate directions, shape (..., 3); the dtype is kept."""
        directions = np.asarray(directions)
        rotated = directions @ self.matrix.T.astype(directions.dtype)
        return rotated.astype(directions.dtype, copy=False)


def direction_from_azimuth_elevation(azimuth: ArrayLike, elevation: ArrayLike) -> FloatArray:
    """Unit directions (..., 3) that look at this azimuth and elevation, in radians."""
    azimuth, elevation = np.broadcast_arrays(np.asarray(azimuth), np.asarray(elevation))
    horizontal = np.cos(elevation)
    return np.stack(
        [horizontal * np.sin(azimuth), np.sin(elevation), -horizontal * np.cos(azimuth)], axis=-1
    )


def azimuth_elevation_from_direction(direction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Azimuth in (-pi, pi] and elevation in [-pi/2, pi/2] of directions (..., 3) of any length."""
    direction = np.asarray(direction)
    x, y, z = direction[..., 0], direction[..., 1], direction[..., 2]
    return np.arctan2(x, -z), np.arctan2(y, np.hypot(x, z))


def angle_between(a: FloatArray, b: FloatArray) -> FloatArray:
    """The angle in radians between directions (..., 3), exact also when it is tiny."""
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    cross = np.linalg.norm(np.cross(a, b), axis=-1)
    return np.asarray(np.arctan2(cross, np.sum(a * b, axis=-1)))


# The same direction d = (x, y, z) of our frame, as other tools write it. All are proper
# rotations. Where a tool also samples its maps differently, the adapter in `io` resamples.
TOOL_FROM_PANOKIT: dict[str, Rotation] = {
    "panokit": Rotation.identity(),
    "skylibs": Rotation.identity(),
    "mitsuba": Rotation(np.diag([-1.0, 1.0, -1.0])),
    "openexr": Rotation(np.diag([-1.0, 1.0, -1.0])),
    "usd": Rotation(np.diag([-1.0, 1.0, -1.0])),
    "blender": Rotation(np.array([[0.0, 0, -1], [-1, 0, 0], [0, 1, 0]])),
    "threejs": Rotation(np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])),
}

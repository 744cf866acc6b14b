"""The poses of street-imagery services as rotations, and back.

Every function gives or takes `world_from_camera`: camera axes right, up and *back* (the camera
looks along -Z), world axes east, up and south, as in `panokit.frames`. The camera of a
spherical picture looks at the picture's center.

| service   | heading                    | up and down                  | sideways                 |
|-----------|----------------------------|------------------------------|--------------------------|
| Google    | `heading`, of the center   | `tilt`: 90 level, 180 zenith | `roll` in [0, 360)       |
| Panoramax | `view:azimuth`             | `pers:pitch`: positive is up | `pers:roll`              |
| GPano     | `PoseHeadingDegrees`       | `PosePitchDegrees`: positive | `PoseRollDegrees`        |
|           |                            | is up                        | in (-180, 180]           |
| Mapillary | `computed_rotation`: one angle-axis vector for all three                            |

Headings are compass directions, clockwise from north. Heading comes first, then pitch, then
roll, each about the axes that the one before left. Roll is positive when the camera leans to
its right, so that the horizon in the picture falls to the left. GPano fixes the order and
the sign of pitch; the sign of roll is said by none of the services and is read alike for all.
"""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation as Turn

from panokit.errors import UsageError
from panokit.frames import Rotation

# Mapillary's world is east, north, up; its camera is right, down, forward.
_WORLD_FROM_EAST_NORTH_UP = Rotation(np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]))
_RIGHT_DOWN_FORWARD_FROM_CAMERA = Rotation(np.diag([1.0, -1.0, -1.0]))


def from_gpano(heading_deg: float, pitch_deg: float = 0.0, roll_deg: float = 0.0) -> Rotation:
    """`world_from_camera` of the Pose properties of photo-sphere metadata.

    Raises:
        UsageError: If an angle is not finite.
    """
    angles = np.array([heading_deg, pitch_deg, roll_deg], np.float64)
    if not np.all(np.isfinite(angles)):
        raise UsageError(f"The angles of a pose are finite, not {angles.tolist()}.")
    heading, pitch, roll = np.deg2rad(angles).tolist()
    return Rotation.from_heading_pitch_roll(heading, pitch, roll)


def to_gpano(world_from_camera: Rotation) -> tuple[float, float, float]:
    """Heading in [0, 360), pitch in [-90, 90], roll in (-180, 180], in degrees."""
    heading, pitch, roll = np.rad2deg(world_from_camera.heading_pitch_roll()).tolist()
    return _turn(heading), pitch, 180.0 if roll == -180.0 else roll


def from_google(heading_deg: float, tilt_deg: float = 90.0, roll_deg: float = 0.0) -> Rotation:
    """`world_from_camera` of Street View metadata.

    Args:
        heading_deg: Of the center column.
        tilt_deg: 0 looks straight down, 90 is level, 180 looks straight up.
        roll_deg: In [0, 360), so that a small lean to the left is near 360.
    """
    return from_gpano(heading_deg, tilt_deg - 90.0, roll_deg)


def to_google(world_from_camera: Rotation) -> tuple[float, float, float]:
    """Heading in [0, 360), tilt in [0, 180] and roll in [0, 360), in degrees."""
    heading, pitch, roll = to_gpano(world_from_camera)
    return heading, pitch + 90.0, _turn(roll)


def from_panoramax(azimuth_deg: float, pitch_deg: float = 0.0, roll_deg: float = 0.0) -> Rotation:
    """`world_from_camera` of `view:azimuth`, `pers:pitch` and `pers:roll` of a STAC item."""
    return from_gpano(azimuth_deg, pitch_deg, roll_deg)


def to_panoramax(world_from_camera: Rotation) -> tuple[float, float, float]:
    """`view:azimuth` in [0, 360), `pers:pitch` and `pers:roll`, in degrees."""
    return to_gpano(world_from_camera)


def from_mapillary(computed_rotation: Sequence[float]) -> Rotation:
    """`world_from_camera` of a Mapillary image's `computed_rotation`.

    Args:
        computed_rotation: Three numbers: the axis, as long as the angle in radians. The
            rotation turns east-north-up into the camera's right-down-forward (OpenSfM).

    Raises:
        UsageError: If they are not three finite numbers.
    """
    vector = np.asarray(computed_rotation, np.float64)
    if vector.shape != (3,) or not np.all(np.isfinite(vector)):
        raise UsageError(f"A computed_rotation is three finite numbers, not {computed_rotation}.")
    angle = float(np.linalg.norm(vector))
    camera_from_world = Rotation.about_axis(vector, angle) if angle else Rotation.identity()
    return _WORLD_FROM_EAST_NORTH_UP @ camera_from_world.inverse @ _RIGHT_DOWN_FORWARD_FROM_CAMERA


def to_mapillary(world_from_camera: Rotation) -> tuple[float, float, float]:
    """The angle-axis vector that `from_mapillary` would take, no longer than pi."""
    camera_from_world = (
        _RIGHT_DOWN_FORWARD_FROM_CAMERA @ world_from_camera.inverse @ _WORLD_FROM_EAST_NORTH_UP
    )
    # Near half a turn the matrix alone hardly knows the axis; by way of a quaternion it does.
    x, y, z = Turn.from_matrix(camera_from_world.matrix).as_rotvec().tolist()
    return x, y, z


def _turn(angle_deg: float) -> float:
    """The same angle in [0, 360); the remainder of a tiny negative one rounds to 360."""
    turned = angle_deg % 360.0
    return 0.0 if turned == 360.0 else turned

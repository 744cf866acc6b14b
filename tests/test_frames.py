import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.frames import (
    TOOL_FROM_PANOKIT,
    Rotation,
    angle_between,
    azimuth_elevation_from_direction,
    direction_from_azimuth_elevation,
)

NORTH, EAST, UP = np.array([0.0, 0, -1]), np.array([1.0, 0, 0]), np.array([0.0, 1, 0])


def test_azimuth_is_a_compass():
    np.testing.assert_allclose(direction_from_azimuth_elevation(0, 0), NORTH, atol=1e-12)
    np.testing.assert_allclose(direction_from_azimuth_elevation(np.pi / 2, 0), EAST, atol=1e-12)
    np.testing.assert_allclose(direction_from_azimuth_elevation(1.0, np.pi / 2), UP, atol=1e-12)


def test_heading_turns_the_camera_clockwise():
    world_from_camera = Rotation.from_heading_pitch_roll(np.pi / 2)
    np.testing.assert_allclose(world_from_camera.apply(NORTH), EAST, atol=1e-12)


def test_positive_pitch_looks_up_and_positive_roll_leans_right():
    nodded = Rotation.from_heading_pitch_roll(0, 0.3)
    assert nodded.apply(NORTH)[1] == pytest.approx(np.sin(0.3))
    leaned = Rotation.from_heading_pitch_roll(0, 0, 0.3)
    assert leaned.apply(UP)[0] == pytest.approx(np.sin(0.3))


def test_looking_straight_up_keeps_the_heading():
    rotation = Rotation.from_heading_pitch_roll(0.7, np.pi / 2)
    heading, pitch, roll = rotation.heading_pitch_roll()
    assert (heading, pitch, roll) == pytest.approx((0.7, np.pi / 2, 0), abs=1e-6)


def test_tool_frames_put_forward_where_the_tools_do():
    seen = {name: rotation.apply(NORTH) for name, rotation in TOOL_FROM_PANOKIT.items()}
    np.testing.assert_allclose(seen["mitsuba"], [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(seen["blender"], [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(seen["threejs"], [1, 0, 0], atol=1e-12)
    assert TOOL_FROM_PANOKIT["blender"].apply(UP)[2] == 1


@pytest.mark.parametrize("matrix", [np.eye(2), np.diag([1.0, 1, -1]), 2 * np.eye(3)])
def test_what_is_not_a_rotation_is_refused(matrix):
    with pytest.raises(UsageError):
        Rotation(matrix)


def test_directions_keep_their_dtype_and_matrix_is_read_only():
    rotation = Rotation.about_axis((1, 2, 3), 0.5)
    assert rotation.apply(np.ones((4, 3), np.float32)).dtype == np.float32
    with pytest.raises(ValueError, match="read-only"):
        rotation.matrix[0, 0] = 5


def test_small_angles_are_not_rounded_away():
    a = direction_from_azimuth_elevation(0.2, 0.1)
    b = Rotation.about_axis((0, 1, 0), 1e-9).apply(a)
    assert angle_between(a, b) == pytest.approx(1e-9 * np.cos(0.1), rel=1e-4)
    assert Rotation.about_axis((0, 1, 0), 1e-9).angle == pytest.approx(1e-9, rel=1e-6)


def test_azimuth_and_elevation_of_any_length():
    azimuth, elevation = azimuth_elevation_from_direction(
        7 * direction_from_azimuth_elevation(2, 1)
    )
    assert (azimuth, elevation) == pytest.approx((2, 1))

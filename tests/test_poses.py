"""Marks seen by cameras of known pose land where they must; every convention returns itself."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from panokit.errors import UsageError
from panokit.frames import Rotation, azimuth_elevation_from_direction
from panokit.poses import (
    from_google,
    from_gpano,
    from_mapillary,
    from_panoramax,
    to_google,
    to_gpano,
    to_mapillary,
    to_panoramax,
)

AHEAD, RIGHT, ABOVE = np.array([0.0, 0, -1]), np.array([1.0, 0, 0]), np.array([0.0, 1, 0])
EAST, NORTH, UP = np.array([1.0, 0, 0]), np.array([0.0, 0, -1]), np.array([0.0, 1, 0])


def place(direction):
    """Compass direction and height of a world direction, in degrees."""
    azimuth, elevation = azimuth_elevation_from_direction(direction)
    return round(float(np.rad2deg(azimuth)) % 360, 6), round(float(np.rad2deg(elevation)), 6)


def test_a_camera_that_heads_east_at_tilt_100_has_its_mark_ten_degrees_up_in_the_east():
    pose = from_google(90.0, 100.0, 0.0)
    assert place(pose.apply(AHEAD)) == (90, 10)
    # Its right is south, level; its own top leans back to the west.
    assert place(pose.apply(RIGHT)) == (180, 0)
    assert place(pose.apply(ABOVE)) == (270, 80)
    # A mark on the eastern horizon is below the center of its picture.
    assert place(pose.inverse.apply(EAST)) == (0, -10)


@pytest.mark.parametrize(
    ("tilt", "height"), [(0.0, -90.0), (85.794815, -4.205185), (90.0, 0.0), (180.0, 90.0)]
)
def test_googles_tilt_counts_from_straight_down(tilt, height):
    assert place(from_google(0.0, tilt).apply(AHEAD))[1] == pytest.approx(height)


def test_googles_roll_wraps():
    # 354.46985 is a lean of 5.53015 degrees to the left, so the right side is up.
    pose = from_google(0.0, 90.0, 354.46985)
    assert place(pose.apply(RIGHT)) == (90, 5.53015)
    np.testing.assert_allclose(to_google(pose), (0, 90, 354.46985))
    assert to_gpano(pose)[2] == pytest.approx(-5.53015)


def test_roll_leans_right_in_every_service_that_has_one():
    for pose in (
        from_google(40.0, 90.0, 12.0),
        from_panoramax(40.0, 0.0, 12.0),
        from_gpano(40.0, 0.0, 12.0),
    ):
        assert place(pose.apply(AHEAD)) == (40, 0)
        assert place(pose.apply(RIGHT)) == (130, -12)
        # What stands upright in the world leans to the left in the picture.
        assert pose.inverse.apply(UP)[0] < 0


def test_heading_comes_first_then_pitch_then_roll():
    pose = from_panoramax(200.0, -30.0, 60.0)
    assert place(pose.apply(AHEAD)) == (200, -30)
    by_hand = (
        Rotation.about_axis((0, 1, 0), -np.deg2rad(200))
        @ Rotation.about_axis((1, 0, 0), np.deg2rad(-30))
        @ Rotation.about_axis((0, 0, -1), np.deg2rad(60))
    )
    np.testing.assert_allclose(pose.matrix, by_hand.matrix, atol=1e-12)


def test_a_level_mapillary_camera_that_looks_north_is_a_quarter_turn():
    pose = from_mapillary([np.pi / 2, 0, 0])
    np.testing.assert_allclose(pose.apply(AHEAD), NORTH, atol=1e-12)
    np.testing.assert_allclose(pose.apply(ABOVE), UP, atol=1e-12)
    np.testing.assert_allclose(pose.apply(RIGHT), EAST, atol=1e-12)


def test_a_real_mapillary_record_has_the_heading_it_states():
    # The image's own computed_compass_angle is 165.86355589155.
    pose = from_mapillary([0.31811377810602, -1.8970785219694, 2.3246601655456])
    heading, pitch, _ = to_gpano(pose)
    assert heading == pytest.approx(165.86355589155, abs=1e-3)
    assert pitch == pytest.approx(10.97, abs=0.01)


def test_mapillarys_axes_by_hand():
    """The mark through OpenSfM's own words: R turns east-north-up into right-down-forward."""
    vector = np.array([0.3, -1.2, 0.8])
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
    east, north, up = rotation.T @ [0, 0, 1]  # forward of the camera, in the world
    np.testing.assert_allclose(from_mapillary(vector).apply(AHEAD), [east, up, -north], atol=1e-12)
    east, north, up = rotation.T @ [1, 0, 0]
    np.testing.assert_allclose(from_mapillary(vector).apply(RIGHT), [east, up, -north], atol=1e-12)


angles = st.tuples(st.floats(0, 359.99), st.floats(-89, 89), st.floats(-179.9, 179.9))


@given(angles)
def test_every_convention_returns_its_own_angles(pose):
    heading, pitch, roll = pose
    for there, back in ((from_gpano, to_gpano), (from_panoramax, to_panoramax)):
        returned = back(there(*pose))
        np.testing.assert_allclose(
            np.exp(1j * np.deg2rad(returned)), np.exp(1j * np.deg2rad(pose)), atol=1e-9
        )
        assert 0 <= returned[0] < 360
        assert -180 < returned[2] <= 180
    google = to_google(from_google(heading, pitch + 90, roll % 360))
    np.testing.assert_allclose(google[1], pitch + 90, atol=1e-9)
    assert 0 <= google[0] < 360
    assert 0 <= google[2] < 360


@given(angles)
@example((0.0, -89.0, 177.0))  # nearly half a turn
def test_a_rotation_survives_mapillarys_vector(pose):
    rotation = from_gpano(*pose)
    vector = to_mapillary(rotation)
    assert np.linalg.norm(vector) <= np.pi + 1e-9
    np.testing.assert_allclose(from_mapillary(vector).matrix, rotation.matrix, atol=1e-7)


@pytest.mark.parametrize("vector", [(np.pi, 0, 0), (0, np.pi, 0), (1e-9, 0, 0), (0, 0, 0)])
def test_no_turn_and_half_a_turn(vector):
    back = to_mapillary(from_mapillary(vector))
    np.testing.assert_allclose(
        from_mapillary(back).matrix, from_mapillary(vector).matrix, atol=1e-8
    )


def test_what_is_no_pose():
    with pytest.raises(UsageError, match="finite"):
        from_google(float("nan"))
    for vector in ([1, 2], [1, 2, np.inf], [[1, 2, 3]]):
        with pytest.raises(UsageError, match="three finite numbers"):
            from_mapillary(vector)

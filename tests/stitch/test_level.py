import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.capture import local_capture
from panokit.frames import Frame, Rotation, angle_between
from panokit.sphere import equirect_directions
from panokit.stitch.level import leveling_from, turn, whole_columns

WIDTH = 256
angles = st.floats(-1, 1)


def beacon(direction, width_px=WIDTH):
    """A picture with one soft bright mark in a direction."""
    away = angle_between(equirect_directions(width_px, width_px // 2), direction)
    mark = 255 * np.exp(-((away / 0.06) ** 2))
    return np.repeat(mark[..., None], 3, axis=2).astype(np.uint8)


def direction_of_mark(pixels):
    """Where the mark is: the mean direction, each pixel counting by its solid angle."""
    directions = equirect_directions(pixels.shape[1], pixels.shape[0])
    weight = pixels[..., 0] * np.hypot(directions[..., 0], directions[..., 2])
    return (directions * weight[..., None]).sum(axis=(0, 1))


@settings(max_examples=40, deadline=None)
@given(
    heading_deg=st.floats(0, 360),
    pitch_deg=st.floats(-60, 60),
    roll_deg=st.floats(-180, 180),
    mark=st.tuples(angles, angles, angles).filter(lambda d: np.linalg.norm(d) > 0.1),
)
def test_a_mark_in_the_world_lands_where_the_world_has_it(heading_deg, pitch_deg, roll_deg, mark):
    world = np.array(mark) / np.linalg.norm(mark)
    capture = local_capture("x", heading_deg=heading_deg, pitch_deg=pitch_deg, roll_deg=roll_deg)
    in_camera = capture.world_from_camera.inverse.apply(world)
    leveling = leveling_from(capture)
    leveled, _ = turn(beacon(in_camera), None, leveling.target_from_camera)
    assert leveling.frame is Frame.WORLD
    assert angle_between(direction_of_mark(leveled), world) < np.deg2rad(0.8)


@given(heading_deg=st.floats(0, 360), pitch_deg=st.floats(-80, 80), roll_deg=st.floats(-180, 180))
def test_pitch_and_roll_alone_turn_the_vertical_upright(heading_deg, pitch_deg, roll_deg):
    truth = local_capture("x", heading_deg=heading_deg, pitch_deg=pitch_deg, roll_deg=roll_deg)
    up_in_camera = truth.world_from_camera.inverse.apply(np.array([0.0, 1, 0]))
    leveling = leveling_from(local_capture("x", pitch_deg=pitch_deg, roll_deg=roll_deg))
    up = leveling.target_from_camera.apply(up_in_camera)
    assert leveling.frame is Frame.LEVEL
    assert np.allclose(up, [0, 1, 0], atol=1e-9)


def test_a_camera_that_faces_east_has_north_a_quarter_to_its_left():
    # Where the picture's center column looks, its compass says: 90 degrees is east.
    leveling = leveling_from(local_capture("x", heading_deg=90.0))
    center = beacon(np.array([0.0, 0, -1]))
    turned, _ = turn(center, None, leveling.target_from_camera)
    assert np.array_equal(turned, np.roll(center, WIDTH // 4, axis=1))
    assert (leveling.known, leveling.assumed) == (("heading",), ("pitch", "roll"))


def test_a_camera_that_looks_up_has_the_horizon_below_its_center():
    leveling = leveling_from(local_capture("x", heading_deg=0.0, pitch_deg=20.0, roll_deg=0.0))
    turned, _ = turn(beacon(np.array([0.0, 0, -1])), None, leveling.target_from_camera)
    up = direction_of_mark(turned)
    assert np.rad2deg(np.arcsin(up[1] / np.linalg.norm(up))) == pytest.approx(20, abs=0.5)


def test_a_camera_that_leans_right_sees_the_zenith_on_its_left():
    leveling = leveling_from(local_capture("x", heading_deg=0.0, pitch_deg=0.0, roll_deg=30.0))
    zenith_in_camera = np.array([-np.sin(np.pi / 6), np.cos(np.pi / 6), 0])
    assert np.allclose(leveling.target_from_camera.apply(zenith_in_camera), [0, 1, 0])


def test_nothing_known_is_taken_as_level_and_stays_as_it_is(scene):
    leveling = leveling_from(local_capture("x"))
    picture = scene(WIDTH)
    turned, _ = turn(picture, None, leveling.target_from_camera)
    assert leveling.frame is Frame.LEVEL
    assert leveling.known == ()
    assert leveling.assumed == ("pitch", "roll")
    assert turned is picture


def test_a_heading_that_is_no_number_is_unknown():
    assert leveling_from(local_capture("x", heading_deg=float("nan"))).frame is Frame.LEVEL


@given(heading_deg=st.floats(-720, 720))
def test_a_heading_moves_whole_columns_and_misses_by_half_a_column_at_most(heading_deg):
    rotation = Rotation.from_heading_pitch_roll(np.deg2rad(heading_deg))
    columns = whole_columns(rotation, WIDTH)
    left_over = heading_deg - columns * 360 / WIDTH
    assert abs((left_over + 180) % 360 - 180) <= 180 / WIDTH + 1e-6


def test_a_tilt_of_a_hundredth_pixel_is_not_worth_interpolating():
    tilt = Rotation.from_heading_pitch_roll(0.0, 0.01 * 2 * np.pi / WIDTH, 0.0)
    assert whole_columns(tilt, WIDTH) == 0
    assert whole_columns(Rotation.from_heading_pitch_roll(0.0, 0.1, 0.0), WIDTH) is None


@settings(max_examples=25, deadline=None)
@given(heading=st.floats(0, 6.2), pitch=st.floats(-0.6, 0.6), roll=st.floats(-0.6, 0.6))
def test_the_valid_mask_follows_the_pixels(heading, pitch, roll):
    rotation = Rotation.from_heading_pitch_roll(heading, pitch, roll)
    valid = np.ones((WIDTH // 2, WIDTH), bool)
    valid[40:60, 20:70] = False
    picture = np.where(valid[..., None], 200, 0).astype(np.uint8).repeat(3, axis=2)
    turned, still_valid = turn(picture, valid, rotation)
    # No black from the hole may have leaked into a pixel that counts as valid.
    assert np.all(turned[still_valid] == 200)
    assert np.all(turned[~still_valid] == 0)
    center = rotation.apply(equirect_directions(WIDTH, WIDTH // 2)[50, 45])
    nearest = angle_between(equirect_directions(WIDTH, WIDTH // 2), center).argmin()
    assert not still_valid.flat[nearest]

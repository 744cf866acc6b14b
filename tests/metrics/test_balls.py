"""Balls under beacons of known place, and laws of energy and scale."""

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.frames import direction_from_azimuth_elevation
from panokit.metrics.balls import (
    ball_error,
    ball_error_scale_invariant,
    diffuse_ball,
    glossy_ball,
    mirror_ball,
)
from panokit.sphere import equirect_directions

BALLS = [diffuse_ball, mirror_ball, glossy_ball]
WEST, NORTH, EAST, SOUTH = np.deg2rad([-90, 0, 90, 180])


def beacon(azimuth: float, elevation_deg: float = 0.0, width: int = 128) -> np.ndarray:
    """A lamp 15 degrees wide on a black map."""
    toward = direction_from_azimuth_elevation(azimuth, np.deg2rad(elevation_deg))
    near = equirect_directions(width, width // 2) @ toward > np.cos(np.deg2rad(7.5))
    return np.where(near[..., None], np.float32(10), np.float32(0)).repeat(3, 2)


def centroid(ball: np.ndarray) -> tuple[float, float]:
    """Where the light on the ball is, x to the right and y up, in radii."""
    light = ball[..., :3].sum(axis=2) * ball[..., 3]
    size = ball.shape[0]
    across = (np.arange(size) + 0.5) / size * 2 - 1
    total = light.sum()
    return float((light.sum(0) * across).sum() / total), float(
        -(light.sum(1) * across).sum() / total
    )


@pytest.mark.parametrize("ball", BALLS)
@pytest.mark.parametrize(
    ("azimuth", "elevation_deg", "x", "y"),
    [(WEST, 0, -1, 0), (EAST, 0, 1, 0), (0.0, 90, 0, 1), (0.0, -90, 0, -1), (SOUTH, 0, 0, 0)],
)
def test_light_from_one_side_lights_that_side(ball, azimuth, elevation_deg, x, y):
    found = centroid(ball(beacon(azimuth, elevation_deg), 64))
    assert np.sign(np.round(found, 1)).tolist() == [x, y]


def test_mirror_ball_shows_a_lamp_where_the_law_of_reflection_puts_it():
    # The normal halves the angle between the lamp (90 degrees to the east) and the camera.
    x, y = centroid(mirror_ball(beacon(EAST), 128))
    assert x == pytest.approx(np.sin(np.pi / 4), abs=0.02)
    assert y == pytest.approx(0, abs=0.01)


def test_light_from_behind_the_ball_reaches_only_its_rim():
    front = diffuse_ball(beacon(SOUTH), 64)[32, 32, :3]
    behind = diffuse_ball(beacon(NORTH), 64)[32, 32, :3]
    assert front.min() > 0
    assert behind.max() < 1e-3 * front.min()


@pytest.mark.parametrize("ball", BALLS)
def test_uniform_light_gives_a_uniform_ball_of_the_same_radiance(ball):
    picture = ball(np.full((64, 128, 3), 2.5, np.float32), 32)
    covered = picture[picture[..., 3] > 0]
    assert covered[:, :3] == pytest.approx(2.5, rel=5e-3)


def test_alpha_is_the_area_of_the_disc():
    picture = diffuse_ball(np.ones((16, 32, 3), np.float32), 64)
    assert picture[..., 3].mean() == pytest.approx(np.pi / 4, rel=1e-3)
    assert picture[0, 0, 3] == 0
    assert picture[32, 32, 3] == 1


def test_a_small_sun_in_a_big_map_keeps_its_energy_on_the_diffuse_ball():
    # The parcel of one texel at the camera's side, seen face on: E = L dOmega.
    radiance = np.zeros((256, 512, 3), np.float32)
    radiance[128, 0] = 1e5
    middle = diffuse_ball(radiance, 65)[32, 32, 0]
    texel = 2 * np.pi / 512 * np.pi / 256
    assert middle == pytest.approx(1e5 * texel / np.pi, rel=0.01)


def test_errors_tell_scale_from_shading():
    west, east = (diffuse_ball(beacon(a), 32) for a in (WEST, EAST))
    doubled = west * np.array([2, 2, 2, 1], np.float32)
    assert ball_error(west, west) == 0
    assert ball_error(doubled, west) == pytest.approx(1)
    assert ball_error_scale_invariant(doubled, west) == pytest.approx(0, abs=1e-6)
    assert ball_error_scale_invariant(east, west) > 0.9


def test_wrong_arguments_are_refused():
    radiance = np.ones((16, 32, 3), np.float32)
    with pytest.raises(UsageError, match="4 to 2048"):
        diffuse_ball(radiance, 2)
    with pytest.raises(UsageError, match="exponent"):
        glossy_ball(radiance, 32, exponent=0)
    with pytest.raises(UsageError, match="one shape"):
        ball_error(diffuse_ball(radiance, 8), diffuse_ball(radiance, 16))

"""The bear on the floor: its shadow, its symmetry, and light that does not reach it."""

import numpy as np
import pytest

from panokit.metrics.transport import relight
from panokit.metrics.transport.figure import BEAR_ALBEDO, FLOOR_ALBEDO, SPHERES, hidden, see
from panokit.sphere import equirect_directions
from panokit.sphere.solid_angle import pixel_solid_angles


def beacon(azimuth_deg, elevation_deg, width=512):
    """A lamp of 5 degrees with the irradiance 1 across its light."""
    azimuth, elevation = np.deg2rad([azimuth_deg, elevation_deg])
    toward = np.array(
        [
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
            -np.cos(elevation) * np.cos(azimuth),
        ]
    )
    near = equirect_directions(width, width // 2) @ toward.astype(np.float32) > np.cos(0.0436)
    solid_angle = (pixel_solid_angles(width // 2) * near).sum()
    return np.where(near[..., None], np.float32(1 / solid_angle), np.float32(0)).repeat(3, 2)


def test_floor_in_the_open_receives_the_cosine():
    picture = relight(beacon(90, 40), "plane")
    # At the lamp's side nothing stands between.
    expected = FLOOR_ALBEDO / np.pi * np.sin(np.deg2rad(40))
    assert picture[30:40, 55:62, 0] == pytest.approx(expected, rel=0.02)
    assert (picture[..., 3] == 1).all()


@pytest.mark.parametrize(("azimuth_deg", "shaded", "lit"), [(90, 12, 52), (-90, 52, 12)])
def test_shadow_falls_away_from_the_light(azimuth_deg, shaded, lit):
    picture = relight(beacon(azimuth_deg, 35), "plane")[..., 0]
    assert picture[46, shaded] == pytest.approx(0, abs=1e-3)
    assert picture[46, lit] > 0.05


def test_shadow_of_a_lamp_behind_the_bear_comes_toward_the_camera():
    behind, before = (relight(beacon(azimuth, 50), "plane")[..., 0] for azimuth in (0, 180))
    assert behind[52, 32] < 0.1 * before[52, 32]


def test_bear_faces_the_light():
    picture = relight(beacon(180, 45), "plane")[..., 0]
    # The forehead's normal is near the lamp.
    assert picture.max() == pytest.approx(BEAR_ALBEDO / np.pi, rel=0.03)


def test_light_from_below_the_floor_is_dark():
    assert np.abs(relight(beacon(30, -20), "plane")[..., :3]).max() < 1e-6


def test_the_bear_is_the_same_in_a_looking_glass():
    radiance = np.random.default_rng(3).exponential(size=(64, 128, 3)).astype(np.float32)
    picture = relight(radiance, "plane")[..., :3]
    reflected = relight(radiance[:, ::-1], "plane")[:, ::-1, :3]
    # Up to the table's steps of a sixteenth.
    difference = picture - reflected
    assert np.sqrt((difference**2).mean()) < 2e-3 * picture.mean()


def test_under_an_even_sky_the_floor_darkens_toward_the_bear():
    picture = relight(np.ones((64, 128, 3), np.float32), "plane")[..., 0]
    assert picture[60, 2] == pytest.approx(FLOOR_ALBEDO, rel=0.06)
    floor = picture[44, 44:63]
    assert floor[0] < 0.93 * floor[-1]
    assert (np.diff(floor) > -2e-3).all()
    # Between the feet next to nothing of the sky is left.
    assert picture.min() < 0.3 * FLOOR_ALBEDO


def test_a_sphere_hides_what_is_behind_it_and_nothing_before_it():
    body = SPHERES[0]
    far = np.add(body[:3], [0, 0, 3])
    toward = np.array([[0, 0, -1.0], [0, 0, 1.0], [0, 1.0, 0]])
    assert hidden(far[None], np.array([-1]), toward).tolist() == [[True, False, False]]
    # Just outside the sphere's edge, and the sphere that a point is on.
    beside = np.array([[0, -3 * np.sin(0.18), -3 * np.cos(0.18)]]) / 3
    assert not hidden(far[None], np.array([-1]), beside)[0, 0]
    top = np.add(body[:3], [0, 0, 0.5])
    assert not hidden(top[None], np.array([0]), np.array([[0, 0, 1.0]]))[0, 0]


def test_the_camera_sees_a_bear_on_a_floor():
    hits = see(64, 1)
    assert 0.1 < (hits.sphere >= 0).mean() < 0.3
    assert {*np.unique(hits.sphere)} == {-1, *range(len(SPHERES))}
    on_floor = hits.sphere < 0
    assert hits.place[on_floor][:, 1] == pytest.approx(0, abs=1e-9)
    assert np.linalg.norm(hits.normal, axis=-1) == pytest.approx(1)
    # The head is above the feet, and the left of the picture is -X.
    assert (hits.sphere[:20] == 1).any()
    assert hits.place[32, 0, 0, 0] < 0 < hits.place[32, 63, 0, 0]

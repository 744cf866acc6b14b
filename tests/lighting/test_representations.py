"""The same light in other forms."""

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.lighting.representations import (
    gaussians_from_json,
    gaussians_json,
    latlong_radiance,
    lights_json,
    square_radiance,
)
from panokit.sphere import energy, evaluate_gaussians, light_vector
from tests.lighting.fakes import beacon


@pytest.mark.parametrize("width_px", [64, 128, 256, 512])
def test_the_lat_long_map_has_the_energy_of_the_square_one(width_px):
    rng = np.random.default_rng(1)
    square = rng.lognormal(0, 2, (64, 64, 3)).astype(np.float32)
    square[3, 5] = 1e5
    wide = latlong_radiance(square, width_px)
    assert wide.shape == (width_px // 2, width_px, 3)
    np.testing.assert_allclose(energy(wide), energy(square), rtol=1e-4)


def test_back_it_is_the_square_one_again():
    square = np.random.default_rng(2).lognormal(0, 2, (64, 64, 3)).astype(np.float32)
    np.testing.assert_allclose(square_radiance(latlong_radiance(square, 256)), square, rtol=1e-4)


def test_a_light_stays_where_it_is():
    direction = np.array([0.6, 0.5, -0.4])
    square = beacon(direction)
    for one in (square, latlong_radiance(square, 256)):
        toward = light_vector(one - 0.2)
        away = np.degrees(np.arccos(toward @ direction / np.linalg.norm(toward)
                                    / np.linalg.norm(direction)))  # fmt: skip
        assert away < 4


def test_only_square_maps_become_wider():
    with pytest.raises(UsageError, match="as high as wide"):
        latlong_radiance(np.ones((32, 64, 3), np.float32))


def test_a_sun_is_the_primary_light():
    found = lights_json(EnvironmentMap(radiance=latlong_radiance(beacon([1, 1, -1]))))
    primary = found["primary"]
    assert not found["no_dominant_light"]
    assert primary["azimuth_deg"] == pytest.approx(45, abs=4)
    assert primary["elevation_deg"] == pytest.approx(35.3, abs=3)
    assert primary["color_rgb"][0] > primary["color_rgb"][2]
    assert found["dominance"] is None  # it has no rival at all
    assert found["secondary"] is None
    assert 0 < found["ambient_share"] < 1


def test_two_suns_are_primary_and_secondary():
    radiance = beacon([1, 1, -1]) + beacon([-1, 1, -1], level=0, peak=100)
    found = lights_json(EnvironmentMap(radiance=latlong_radiance(radiance)))
    assert found["secondary"]["azimuth_deg"] == pytest.approx(-45, abs=4)
    assert found["dominance"] == pytest.approx(4, rel=0.05)


def test_an_even_sky_has_no_dominant_light():
    found = lights_json(EnvironmentMap(radiance=np.ones((64, 128, 3), np.float32)))
    assert found["no_dominant_light"]
    assert found["why"] == "no-lights"
    assert found["primary"] is None
    np.testing.assert_allclose(found["ambient_rgb"], 1, rtol=1e-4)


def test_gaussians_say_the_same_light():
    square = beacon([0.2, 1, -0.5], peak=800)
    value = gaussians_json(EnvironmentMap(radiance=latlong_radiance(square, 128)), 6)
    fit = gaussians_from_json(value)
    assert len(fit.axes) == 6
    np.testing.assert_allclose(fit.energies.sum(axis=0), energy(square), rtol=1e-3)
    toward = np.array([0.2, 1, -0.5]) / np.linalg.norm([0.2, 1, -0.5])
    assert evaluate_gaussians(fit, toward)[0] > 10 * evaluate_gaussians(fit, -toward)[0]


def test_a_black_map_has_no_gaussians():
    value = gaussians_json(EnvironmentMap(radiance=np.zeros((64, 128, 3), np.float32)), 6)
    assert value["axes"] == []

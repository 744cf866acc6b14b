"""The sun out of the map: what is taken and what is left are the map."""

import numpy as np
import pytest

from panokit.errors import RecordError
from panokit.frames import angle_between, direction_from_azimuth_elevation
from panokit.io.adapters import AnalyticSun, sun_from_record, take_out_sun
from panokit.sphere import energy, find_lights
from tests.conftest import sun_radiance

TOWARD = direction_from_azimuth_elevation(np.deg2rad(17.0), np.deg2rad(40.0))
SAID = AnalyticSun(direction=TOWARD, irradiance=np.ones(3))


@pytest.mark.parametrize("azimuth_deg", [17.0, 180.0])
def test_the_parts_add_up_to_the_map(azimuth_deg):
    radiance = sun_radiance(512, 40, azimuth_deg=azimuth_deg, diameter_deg=2)
    toward = direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(40.0))
    rest, sun = take_out_sun(radiance, AnalyticSun(direction=toward, irradiance=np.ones(3)))
    np.testing.assert_allclose(energy(rest) + sun.irradiance, energy(radiance), rtol=1e-5)
    assert angle_between(sun.direction, toward) < np.deg2rad(0.3)
    # No sun is left, and no hole where it was.
    assert rest.max() < 2
    assert rest.min() > 0.9 * radiance.min()
    assert not find_lights(rest).lights
    np.testing.assert_allclose(np.rad2deg(sun.angular_radius), 0.2666, atol=1e-4)


def test_what_is_not_sun_is_not_touched():
    radiance = sun_radiance(256, 40, diameter_deg=3)
    rest, _ = take_out_sun(radiance, SAID)
    changed = (rest != radiance).any(axis=-1)
    assert 0 < changed.mean() < 0.002


def test_a_map_without_a_light_there_is_left_alone():
    assert take_out_sun(np.ones((32, 64, 3), np.float32), SAID) is None
    elsewhere = AnalyticSun(direction=-TOWARD, irradiance=np.ones(3))
    assert take_out_sun(sun_radiance(256, 40, diameter_deg=3), elsewhere) is None


def test_it_is_read_from_a_record():
    sun = sun_from_record(SAID.to_json())
    np.testing.assert_allclose(sun.direction, TOWARD, atol=1e-6)
    np.testing.assert_allclose(sun.irradiance, 1)
    for wrong in ({}, {"direction": [1], "irradiance_rgb": [1, 1, 1], "angular_radius_deg": 1}):
        with pytest.raises(RecordError, match="sun"):
            sun_from_record(wrong)

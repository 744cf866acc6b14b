from datetime import UTC, datetime

import numpy as np
import pytest

from panokit.capture import Capture, TimePrecision, license_from_spdx
from panokit.color import luminance
from panokit.expand.lighting import SunHint, describe_lighting, find_sun, sun_hint
from panokit.frames import Frame, angle_between, direction_from_azimuth_elevation
from panokit.sphere import energy, equirect_directions, find_lights, harmonics_map
from panokit.sun import SUN_SOLID_ANGLE, sun_direction

PLACE = (48.5, 7.7)
NOON = datetime(2024, 6, 21, 11, 0, tzinfo=UTC)


def toward(azimuth_deg: float, elevation_deg: float) -> np.ndarray:
    return direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(elevation_deg))


def day(sun: np.ndarray, radius_deg: float = 1.5, light: float = 2e3) -> np.ndarray:
    """A blue sky with a sun and its glare over dull ground, (256, 512, 3)."""
    directions = equirect_directions(512, 256)
    radiance = np.where(directions[..., 1:2] > 0, (0.25, 0.35, 0.55), (0.12, 0.11, 0.1))
    radiance[directions @ sun > np.cos(np.deg2rad(radius_deg))] = light
    return radiance.astype(np.float32)


def night(lamp: np.ndarray) -> np.ndarray:
    """A lamp over lit ground under a black sky."""
    directions = equirect_directions(512, 256)
    radiance = np.where(directions[..., 1:2] > 0, 0.01, (0.3, 0.25, 0.15))
    radiance[directions @ lamp > np.cos(np.deg2rad(1.5))] = 2e3
    return radiance.astype(np.float32)


def capture_at(time: datetime | None) -> Capture:
    return Capture(
        provider="folder",
        id="x",
        license=license_from_spdx("CC0-1.0", ""),
        latitude_deg=PLACE[0],
        longitude_deg=PLACE[1],
        time=time,
        time_precision=None if time is None else TimePrecision.SECOND,
    )


def sun_of(radiance, frame=Frame.LEVEL, capture=None):
    return find_sun(radiance, find_lights(radiance), frame, capture)


def test_a_sun_is_known_by_its_looks():
    sun = sun_of(day(toward(70, 35)))
    assert sun.evidence == "appearance"
    assert np.degrees(angle_between(sun.direction, toward(70, 35))) < 0.5
    expected = 2e3 * 2 * np.pi * (1 - np.cos(np.deg2rad(1.5)))
    assert luminance(sun.irradiance) == pytest.approx(expected, rel=0.05)


def test_lamps_at_night_suns_below_the_horizon_and_soft_skies_are_none():
    assert sun_of(night(toward(20, 45))) is None
    assert sun_of(day(toward(20, -30))) is None
    assert sun_of(day(toward(20, 40), radius_deg=25, light=3)) is None
    assert sun_of(day(toward(20, 40)), Frame.CAMERA) is None


def test_time_and_place_tell_where_the_sun_is():
    known = sun_direction(*PLACE, NOON)
    blurred = toward(*(np.array([180.0, 62.0])))
    assert np.degrees(angle_between(known, blurred)) < 20
    radiance = day(known)
    sun = sun_of(radiance, Frame.WORLD, capture_at(NOON))
    assert sun.evidence == "ephemeris"
    assert sun.direction == pytest.approx(known, abs=1e-6)
    # Another light, as bright, far from where the sun was, is not it.
    assert sun_of(day(toward(-60, 20)), Frame.WORLD, capture_at(NOON)) is None
    # Without north the time does not help, and looks decide.
    assert sun_of(day(toward(-60, 20)), Frame.LEVEL, capture_at(NOON)).evidence == "appearance"
    assert sun_of(radiance, Frame.WORLD, capture_at(None)).evidence == "appearance"


def test_after_sunset_there_is_no_sun():
    midnight = capture_at(datetime(2024, 6, 21, 23, 30, tzinfo=UTC))
    assert sun_of(day(toward(0, 20)), Frame.WORLD, midnight) is None


def test_the_record_tells_lights_sun_and_harmonics():
    radiance = day(toward(70, 35))
    found = describe_lighting(radiance, Frame.LEVEL, None, most_lights=3, harmonics_order=3)
    assert found["has_dominant_light"] is True
    assert found["sun"]["angular_radius_deg"] == pytest.approx(0.2666, abs=1e-3)
    assert found["sun"]["azimuth_deg"] == pytest.approx(70, abs=0.5)
    assert found["sun"]["elevation_deg"] == pytest.approx(35, abs=0.5)
    first = found["lights"][0]
    assert first["irradiance_rgb"] == found["sun"]["irradiance_rgb"]
    assert 0 < first["energy_share"] < 1
    rest = np.array(found["ambient_rgb"]) * 4 * np.pi
    whole = rest + np.sum([light["energy_rgb"] for light in found["lights"]], axis=0)
    assert whole == pytest.approx(energy(radiance), rel=1e-4)
    coefficients = np.array(found["harmonics"]["rgb"])
    assert coefficients.shape == (16, 3)
    mean = harmonics_map(coefficients, 64).mean()
    assert mean > 0
    assert coefficients[0] * np.sqrt(4 * np.pi) == pytest.approx(energy(radiance), rel=1e-3)


def test_no_lights_are_listed_where_none_are_wanted_or_none_are_there():
    found = describe_lighting(
        day(toward(70, 35)), Frame.LEVEL, None, most_lights=0, harmonics_order=0
    )
    assert found["lights"] == []
    assert len(found["harmonics"]["rgb"]) == 1
    even = describe_lighting(
        np.ones((64, 128, 3), np.float32), Frame.LEVEL, None, most_lights=4, harmonics_order=2
    )
    assert even["lights"] == []
    assert even["sun"] is None
    assert even["has_dominant_light"] is False


def test_the_analytic_sun_is_as_strong_as_the_real_disk_would_be():
    sun = sun_of(day(toward(70, 35)))
    # A renderer that draws the disk divides by its solid angle.
    assert (sun.irradiance / SUN_SOLID_ANGLE > 1e4).all()


def saw(direction) -> SunHint:
    return SunHint(direction=direction, looked=True)


def test_a_model_that_looked_and_saw_no_sun_is_believed():
    radiance = day(toward(20, 45))
    lights = find_lights(radiance)
    assert find_sun(radiance, lights, Frame.LEVEL, None).evidence == "appearance"
    assert find_sun(radiance, lights, Frame.LEVEL, None, saw(None)) is None
    # One that does not look for suns says nothing.
    silent = SunHint(direction=None, looked=False)
    assert find_sun(radiance, lights, Frame.LEVEL, None, silent).evidence == "appearance"
    # One that sees a sun where there is no light has at least seen a sunny day.
    elsewhere = find_sun(radiance, lights, Frame.LEVEL, None, saw(toward(120, 10)))
    assert elsewhere.evidence == "appearance"


def test_a_model_that_sees_the_sun_is_believed_where_there_is_a_light():
    radiance = night(toward(20, 45))
    lights = find_lights(radiance)
    sun = find_sun(radiance, lights, Frame.CAMERA, None, saw(toward(22, 46)))
    assert sun.evidence == "network"
    assert sun.irradiance == pytest.approx(lights.lights[0].irradiance)
    assert find_sun(radiance, lights, Frame.LEVEL, None, saw(toward(120, 10))) is None


def test_a_hint_is_the_middle_of_the_component_that_is_most_likely_the_sun():
    sun = toward(70, 35)
    radiance = day(sun)
    labels = np.zeros(radiance.shape[:2], np.int32)
    labels[equirect_directions(512, 256) @ sun > np.cos(np.deg2rad(4))] = 2
    labels[200:210, 10:20] = 1
    hint = sun_hint(radiance, labels, np.array([0.1, 0.9]))
    assert np.degrees(angle_between(hint, sun)) < 0.5
    assert sun_hint(radiance, labels, np.array([0.1, 0.4])) is None
    assert sun_hint(radiance, labels, np.zeros(0)) is None

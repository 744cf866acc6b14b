import csv

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.frames import angle_between, direction_from_azimuth_elevation
from panokit.io import read_environment_map
from panokit.sphere import energy, equirect_directions, find_lights, row_solid_angles

WIDTH = 512
D = equirect_directions(WIDTH, WIDTH // 2)


def toward(azimuth_deg, elevation_deg):
    return direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(elevation_deg))


def disk(radiance, azimuth_deg, elevation_deg, radius_deg, value):
    inside = D @ toward(azimuth_deg, elevation_deg) > np.cos(np.deg2rad(radius_deg))
    radiance[inside] = value
    return inside


def clear_sky(azimuth_deg=40, elevation_deg=35, sun=5e4):
    """A blue sky over a dark ground, with a sun and its glow."""
    radiance = np.where(D[..., 1:2] > 0, [0.5, 0.7, 1.2], [0.15, 0.13, 0.1]).astype(np.float32)
    away = angle_between(D, toward(azimuth_deg, elevation_deg))
    radiance += (3 * np.exp(-away / 0.1))[..., None].astype(np.float32)
    return radiance, disk(radiance, azimuth_deg, elevation_deg, 0.6, [sun, 0.9 * sun, 0.7 * sun])


@pytest.mark.parametrize(("azimuth_deg", "elevation_deg"), [(40, 35), (180, 20), (10, 89.5)])
def test_the_sun_of_a_clear_sky_is_one_light_without_its_glow(azimuth_deg, elevation_deg):
    radiance, inside = clear_sky(azimuth_deg, elevation_deg)
    found = find_lights(radiance)
    assert len(found.lights) == 1
    sun = found.primary
    assert np.degrees(angle_between(sun.direction, toward(azimuth_deg, elevation_deg))) < 0.2
    np.testing.assert_array_equal(found.regions == 1, inside)
    solid = np.broadcast_to(row_solid_angles(WIDTH // 2)[:, None], inside.shape)[inside]
    np.testing.assert_allclose(sun.energy, solid @ radiance[inside].astype(float), rtol=1e-6)
    np.testing.assert_allclose(sun.solid_angle_sr, solid.sum(), rtol=1e-9)
    assert np.degrees(sun.angular_radius) == pytest.approx(0.6, abs=0.15)
    np.testing.assert_allclose(sun.color / sun.color[0], [1, 0.9, 0.7], rtol=1e-5)
    np.testing.assert_allclose(sun.radiance, [5e4, 4.5e4, 3.5e4], rtol=1e-5)
    np.testing.assert_allclose(sun.irradiance, sun.energy, rtol=1e-3)
    assert found.secondary is None
    assert found.key_to_fill > 2
    assert found.dominance == np.inf


def test_the_parts_add_up_to_the_map():
    radiance, _ = clear_sky()
    disk(radiance, -120, 10, 6, [40, 30, 10])
    found = find_lights(radiance)
    assert len(found.lights) == 2
    np.testing.assert_allclose(found.energy, energy(radiance), rtol=1e-9)
    lights = sum(light.energy for light in found.lights)
    np.testing.assert_allclose(lights + 4 * np.pi * found.ambient, energy(radiance), rtol=1e-9)


def test_a_uniform_map_a_gradient_and_an_overcast_sky_have_no_light():
    uniform = np.ones((WIDTH // 2, WIDTH, 3), np.float32)
    up = D[..., 1:2]
    # CIE overcast: three times as bright at the zenith as at the horizon, over a dark ground.
    overcast = np.where(up > 0, (1 + 2 * up) / 3, 0.1) * np.ones(3)
    for radiance in (uniform, 1 + 0.9 * up * np.ones(3), overcast, 0 * uniform):
        found = find_lights(radiance)
        assert found.lights == ()
        assert found.primary is None
        assert found.abstained == "no-lights"
        assert found.key_to_fill == found.dominance == 0
        np.testing.assert_allclose(found.ambient * 4 * np.pi, energy(radiance), rtol=1e-5)


def test_two_lamps_are_ranked_and_equal_ones_are_ambiguous():
    room = np.full((WIDTH // 2, WIDTH, 3), 0.1, np.float32)
    disk(room, -60, 40, 5, [30, 30, 30])
    disk(room, 100, 20, 5, [15, 15, 15])
    found = find_lights(room)
    assert np.degrees(angle_between(found.primary.direction, toward(-60, 40))) < 0.3
    assert np.degrees(angle_between(found.secondary.direction, toward(100, 20))) < 0.3
    assert found.dominance == pytest.approx(2, rel=0.02)
    disk(room, 100, 20, 5, [29, 29, 29])
    equal = find_lights(room)
    assert equal.abstained == "ambiguous"
    assert equal.primary is None
    assert equal.secondary is None
    assert len(equal.lights) == 2
    assert find_lights(room, least_dominance=1.0).primary is not None


def test_a_faint_lamp_in_much_other_light_is_weak():
    room = np.full((WIDTH // 2, WIDTH, 3), 1.0, np.float32)
    disk(room, 20, 30, 3, [20, 20, 20])
    found = find_lights(room)
    assert len(found.lights) == 1
    assert found.abstained == "weak"
    assert 0.01 < found.key_to_fill < 0.15
    assert find_lights(room, least_key_to_fill=0.01).primary is not None


def test_a_soft_light_must_be_stronger_than_a_small_one_to_dominate():
    def in_gray(radius_deg, value):
        room = np.full((WIDTH // 2, WIDTH, 3), 1.0, np.float32)
        disk(room, 20, 30, radius_deg, value)
        return find_lights(room)

    small, soft = in_gray(1.5, 450), in_gray(15, 5.5)
    assert soft.key_to_fill == pytest.approx(small.key_to_fill, rel=0.3)
    assert small.primary is not None
    assert soft.abstained == "weak"
    assert in_gray(15, 20).primary is not None


def test_glazing_bars_do_not_make_a_window_many():
    room = np.full((WIDTH // 2, WIDTH, 3), 0.2, np.float32)
    room[90:140, 200:260] = 12
    room[90:140, 219:220] = room[90:140, 239:240] = room[114:115, 200:260] = 0.2
    found = find_lights(room)
    assert len(found.lights) == 1
    assert np.degrees(found.primary.angular_radius) > 15


def test_a_window_on_the_seam_is_one_light():
    room = np.full((WIDTH // 2, WIDTH, 3), 0.2, np.float32)
    room[100:130, :12] = room[100:130, -20:] = 10
    found = find_lights(room)
    assert len(found.lights) == 1
    azimuth = np.degrees(np.arctan2(found.primary.direction[0], -found.primary.direction[2]))
    assert azimuth == pytest.approx(180 - 4 * 360 / WIDTH, abs=0.2)


def test_no_more_lights_than_asked_for():
    room = np.full((WIDTH // 2, WIDTH, 3), 0.1, np.float32)
    for k in range(6):
        disk(room, 60 * k, 10, 2, 20 + 10 * k)
    everything = find_lights(room)
    assert len(everything.lights) == 6
    strengths = [light.luminance for light in everything.lights]
    assert strengths == sorted(strengths, reverse=True)
    three = find_lights(room, most=3)
    assert [light.luminance for light in three.lights] == strengths[:3]
    assert three.regions.max() == 3
    np.testing.assert_allclose(three.energy, energy(room), rtol=1e-9)
    assert find_lights(room, most=0).abstained == "no-lights"


def test_a_large_map_is_averaged_first_and_keeps_its_energy():
    radiance, _ = clear_sky()
    large = radiance.repeat(4, axis=0).repeat(4, axis=1)
    found = find_lights(large)
    assert found.regions.shape == (512, 1024)
    assert len(found.lights) == 1
    np.testing.assert_allclose(found.energy, energy(large), rtol=1e-6)


def test_bad_maps_are_refused():
    with pytest.raises(ImageError, match="wide"):
        find_lights(np.ones((8, 8, 3)))
    with pytest.raises(ImageError, match="RGB"):
        find_lights(np.ones((8, 16)))
    with pytest.raises(ImageError, match="srgb_decode"):
        find_lights(np.ones((8, 16, 3), np.uint8))
    with pytest.raises(ImageError, match="not negative"):
        find_lights(np.full((8, 16, 3), -1.0))
    with pytest.raises(ImageError, match="finite"):
        find_lights(np.full((8, 16, 3), np.inf))
    with pytest.raises(UsageError, match="number of lights"):
        find_lights(np.ones((8, 16, 3)), most=-1)


@pytest.mark.data
def test_real_suns_are_found_as_disks_and_overcast_skies_are_not(shared_data):
    with (shared_data / "probes/manifest.csv").open() as file:
        rows = {row["name"]: row["file"] for row in csv.DictReader(file)}
    suns = ["kloofendal_43d_clear_puresky", "quarry_02", "snowy_field", "studio_garden"]
    for name in suns:
        radiance = read_environment_map(shared_data / "probes" / rows[name], repair=True).radiance
        found = find_lights(radiance)
        assert len(found.lights) == 1
        assert np.degrees(found.primary.angular_radius) < 0.6
    for name in ["kloofendal_overcast", "spree_bank", "pmndrs_venice"]:
        radiance = read_environment_map(shared_data / "probes" / rows[name], repair=True).radiance
        assert find_lights(radiance).primary is None

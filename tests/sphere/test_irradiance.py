import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.frames import direction_from_azimuth_elevation
from panokit.sphere import (
    energy,
    equirect_directions,
    irradiance,
    irradiance_map,
    light_parcels,
    light_vector,
    mean_chromaticity,
)


def normals(count=120, seed=0):
    found = np.random.default_rng(seed).normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def sun_map(elevation_deg, azimuth_deg, sky=0.0, width=1024):
    d = equirect_directions(width, width // 2)
    toward = direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(elevation_deg))
    radiance = np.full((width // 2, width, 3), sky, np.float32)
    radiance[d @ toward > np.cos(np.deg2rad(0.3))] = [6e4, 5e4, 4e4]
    return radiance


def test_a_uniform_sky_gives_pi_whatever_its_size():
    for height, width, limit in [(512, 1024, 3e-4), (100, 200, 5e-4), (125, 250, 5e-4)]:
        received = irradiance(np.ones((height, width, 1), np.float32), normals())
        np.testing.assert_allclose(received, np.pi, rtol=limit)


def test_gradient_skies_match_the_integrals():
    up = equirect_directions(512, 256)[..., 1:2]
    # L = 1 + y gives pi + 2 pi / 3 n_y; L = y^2 gives pi / 4 (1 + n_y^2).
    n = normals()
    received = irradiance(np.concatenate([1 + up, up**2], axis=2), n)
    np.testing.assert_allclose(received[:, 0], np.pi + 2 * np.pi / 3 * n[:, 1], rtol=2e-3)
    np.testing.assert_allclose(received[:, 1], np.pi / 4 * (1 + n[:, 1] ** 2), rtol=2e-3)


@pytest.mark.parametrize("elevation_deg", [-90, -60, 0, 3, 45, 85, 89, 89.9])
def test_a_sun_anywhere_is_right_to_half_a_percent(elevation_deg):
    radiance = sun_map(elevation_deg, 163, sky=0.3)
    exact = irradiance(radiance, normals(), exact=True)
    np.testing.assert_allclose(irradiance(radiance, normals()), exact, rtol=5e-3)
    # And the exact sum is that of a distant light, but where the horizon cuts its disk.
    sun = sun_map(elevation_deg, 163)
    lit = irradiance(sun, normals(), exact=True)[:, 0]
    toward = light_vector(sun) / np.linalg.norm(light_vector(sun))
    expected = energy(sun)[0] * np.maximum(normals() @ toward, 0)
    np.testing.assert_allclose(lit, expected, atol=2e-3 * energy(sun)[0])


def test_random_maps_match_the_full_sum():
    radiance = np.random.default_rng(5).gamma(0.05, 1, (256, 512, 3)).astype(np.float32)
    exact = irradiance(radiance, normals(), exact=True)
    np.testing.assert_allclose(irradiance(radiance, normals()), exact, rtol=1e-3)


@pytest.mark.parametrize("width_px", [16, 64, 30])
def test_the_map_is_irradiance_on_both_sides_and_past_the_seam(width_px):
    radiance = sun_map(20, 130, sky=0.5, width=256)
    whole = irradiance_map(radiance, width_px)
    expected = irradiance(radiance, equirect_directions(width_px, width_px // 2))
    np.testing.assert_allclose(whole, expected, rtol=1e-4)
    assert whole.dtype == np.float32


def test_parcels_keep_the_energy_and_the_light_vector():
    radiance = np.full((125, 250, 3), 0.2, np.float32)
    radiance[37, 249] = [6e4, 5e4, 4e4]
    energies, vectors = light_parcels(radiance, (10, 20))
    assert energies.shape == (200, 3)
    np.testing.assert_allclose(energies.sum(axis=0), energy(radiance), rtol=1e-5)
    weights = np.array([0.2126, 0.7152, 0.0722])
    np.testing.assert_allclose(weights @ vectors.sum(axis=0), light_vector(radiance), rtol=2e-3)


def test_normals_of_any_shape_and_one_channel():
    radiance = np.ones((16, 32, 1))
    assert irradiance(radiance, np.array([0.0, 1, 0])).shape == (1,)
    assert irradiance(radiance, np.ones((2, 5, 3)) / 3**0.5).shape == (2, 5, 1)


def test_mean_chromaticity_counts_energy_not_pixels():
    radiance = np.full((32, 64, 3), 1e-3, np.float32) * np.array([0.2, 0.4, 1.0], np.float32)
    np.testing.assert_allclose(mean_chromaticity(np.ones((8, 16, 3))), [0.3127, 0.329], atol=2e-4)
    radiance[10, 3] = [50, 20, 5]
    x, _ = mean_chromaticity(radiance)
    assert x > 0.45
    assert np.isnan(mean_chromaticity(np.zeros((8, 16, 3)))).all()


def test_bad_calls_say_what_is_wrong():
    with pytest.raises(ImageError, match="shape"):
        irradiance(np.ones((8, 16)), np.eye(3))
    with pytest.raises(ImageError, match="shape"):
        irradiance(np.ones((0, 0, 3)), np.eye(3))
    with pytest.raises(ImageError, match="finite"):
        irradiance(np.full((8, 16, 3), np.nan), np.eye(3))
    with pytest.raises(ImageError, match="srgb_decode"):
        irradiance_map(np.ones((8, 16, 3), np.uint8))
    with pytest.raises(UsageError, match="Normals"):
        irradiance(np.ones((8, 16, 3)), np.ones(2))
    with pytest.raises(UsageError, match="even"):
        irradiance_map(np.ones((8, 16, 3)), 7)

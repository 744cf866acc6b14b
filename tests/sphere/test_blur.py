import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.sphere import (
    blur_radiance,
    energy,
    equirect_directions,
    harmonics_degrees,
    harmonics_map,
    row_solid_angles,
    vmf_factors,
)


def random_map(height=32, seed=0):
    return np.random.default_rng(seed).gamma(0.1, 1, (height, 2 * height, 3)).astype(np.float32)


def brute_force(radiance, kappa):
    height, width = radiance.shape[:2]
    d = equirect_directions(width, height).reshape(-1, 3).astype(np.float64)
    solid_angles = np.repeat(row_solid_angles(height, width), width)
    kernel = np.exp(kappa * (d @ d.T - 1)) * kappa / (2 * np.pi * (1 - np.exp(-2 * kappa)))
    blurred = kernel @ (solid_angles[:, None] * radiance.reshape(-1, 3))
    return blurred.reshape(radiance.shape)


@pytest.mark.parametrize("kappa", [0.5, 3, 12, 40])
def test_it_is_the_sum_over_all_pixels(kappa):
    radiance = random_map(48)
    radiance[10, 0] = 50  # on the seam
    expected = brute_force(radiance, kappa)
    blurred = blur_radiance(radiance, kappa)
    # The plain sum is off by a percent itself where pixels are not small beside the kernel.
    np.testing.assert_allclose(blurred, expected, rtol=0.01)
    inner = slice(12, 36)
    np.testing.assert_allclose(blurred[inner], expected[inner], rtol=1e-3)


@pytest.mark.parametrize("kappa", [4, 60, 400, 3000])
def test_each_harmonic_is_scaled_by_its_factor(kappa):
    # Analytic: the blur multiplies degree l by I_(l+1/2)(kappa) / I_(1/2)(kappa).
    rng = np.random.default_rng(1)
    coefficients = rng.normal(size=(49, 3)) * 0.05
    coefficients[0] = 5
    blurred = blur_radiance(harmonics_map(coefficients, 256), kappa)
    factors = vmf_factors(kappa, 6)[harmonics_degrees(6), None]
    expected = harmonics_map(coefficients * factors, 256)
    np.testing.assert_allclose(blurred, expected, rtol=1e-3)


@pytest.mark.parametrize("kappa", [0, 1, 20, 150, 1e3, 1e4, 1e5])
def test_energy_is_kept_with_suns_on_the_seam_and_the_poles(kappa):
    radiance = random_map(64)
    radiance[0, 3] = radiance[-1, 70] = [6e4, 5e4, 4e4]
    radiance[30, 0] = 1e5
    blurred = blur_radiance(radiance, kappa)
    np.testing.assert_allclose(energy(blurred), energy(radiance), rtol=1e-6)
    assert blurred.min() >= 0
    assert blurred.dtype == np.float32


@pytest.mark.parametrize("kappa", [2, 150, 1e4])
def test_a_uniform_map_stays_uniform(kappa):
    blurred = blur_radiance(np.full((64, 128, 3), 2.5, np.float32), kappa)
    np.testing.assert_allclose(blurred, 2.5, rtol=1e-6)


@pytest.mark.parametrize("kappa", [1e9, 1e15, 1e300, np.inf])
def test_it_becomes_the_identity(kappa):
    radiance = random_map()
    np.testing.assert_array_equal(blur_radiance(radiance, kappa), radiance)


def test_it_nears_the_identity_away_from_the_narrow_pixels_of_the_poles():
    radiance = random_map(64)
    blurred = blur_radiance(radiance, 1e5)
    np.testing.assert_allclose(blurred[20:44], radiance[20:44], rtol=1e-5, atol=1e-9)


def test_zero_is_the_mean():
    radiance = random_map()
    mean = energy(radiance) / (4 * np.pi)
    np.testing.assert_allclose(blur_radiance(radiance, 0), np.broadcast_to(mean, radiance.shape),
                               rtol=1e-5)  # fmt: skip


def test_a_source_at_the_pole_spreads_evenly_round_it():
    radiance = np.zeros((128, 256, 3), np.float32)
    radiance[0] = 100
    for kappa in (10, 300):
        blurred = blur_radiance(radiance, kappa)
        np.testing.assert_allclose(blurred[:, 1:], blurred[:, :-1], rtol=1e-4, atol=1e-9)


def test_bad_calls_say_what_is_wrong():
    with pytest.raises(UsageError, match="kappa"):
        blur_radiance(random_map(), -1)
    with pytest.raises(UsageError, match="kappa"):
        blur_radiance(random_map(), float("nan"))
    with pytest.raises(ImageError, match="not finite"):
        blur_radiance(np.full((8, 16, 3), np.inf), 3)
    with pytest.raises(ImageError, match="srgb_decode"):
        blur_radiance(np.ones((8, 16, 3), np.uint8), 3)
    with pytest.raises(ImageError, match="wide"):
        blur_radiance(np.ones((8, 8, 3)), 3)

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.frames import angle_between
from panokit.sphere import (
    GaussianFit,
    energy,
    equirect_directions,
    evaluate_gaussians,
    fit_gaussians,
    gaussians_irradiance,
    irradiance,
    light_vector,
    lobe_integral,
)
from panokit.sphere.gaussians import spread

D = equirect_directions(256, 128)
TRUTH = GaussianFit(
    axes=np.array([[0.6, 0.8, 0], [0, 0, 1.0], [-0.8, 0, -0.6]]),
    sharpness=np.array([60.0, 15, 30]),
    amplitudes=np.array([[20.0, 15, 5], [1, 2, 4], [4, 4, 4]]),
    irradiance_error=0.0,
)


def test_the_integral_is_the_sum_over_the_sphere():
    for sharpness in (0.0, 1e-9, 0.3, 8.0, 100.0):
        lobe = np.exp(sharpness * (D[..., 2:] - 1.0)).astype(np.float64)
        np.testing.assert_allclose(lobe_integral(np.array([sharpness])), energy(lobe), rtol=1e-3)


def test_irradiance_of_lobes_is_that_of_the_map_they_make():
    radiance = evaluate_gaussians(TRUTH, D)
    np.testing.assert_allclose(
        gaussians_irradiance(TRUTH, spread(60)), irradiance(radiance, spread(60)),
        rtol=5e-3, atol=1e-3,
    )  # fmt: skip


def test_lobes_are_found_again():
    fit = fit_gaussians(evaluate_gaussians(TRUTH, D), 3)
    order = [int(np.argmax(fit.axes @ axis)) for axis in TRUTH.axes]
    assert sorted(order) == [0, 1, 2]
    assert np.degrees(angle_between(fit.axes[order], TRUTH.axes)).max() < 1
    np.testing.assert_allclose(fit.sharpness[order], TRUTH.sharpness, rtol=0.05)
    np.testing.assert_allclose(fit.amplitudes[order], TRUTH.amplitudes, rtol=0.08, atol=0.15)
    assert fit.irradiance_error < 2e-3


@pytest.mark.parametrize("count", [1, 2, 12])
def test_the_energy_is_kept_and_no_amplitude_is_negative(count):
    radiance = np.random.default_rng(0).gamma(0.2, 1, (64, 128, 3)).astype(np.float32)
    radiance[20, 30] = [6e4, 5e4, 4e4]
    fit = fit_gaussians(radiance, count)
    assert fit.axes.shape == (count, 3)
    np.testing.assert_allclose(np.linalg.norm(fit.axes, axis=1), 1)
    assert fit.amplitudes.min() >= 0
    assert fit.sharpness.min() > 0
    np.testing.assert_allclose(fit.energies.sum(axis=0), energy(radiance), rtol=1e-6)


def test_one_lobe_has_the_light_vector():
    radiance = evaluate_gaussians(TRUTH, D)
    fit = fit_gaussians(radiance, 1)
    assert np.degrees(angle_between(fit.axes[0], light_vector(radiance))) < 0.2


def test_a_sun_gets_a_sharp_lobe_and_twelve_are_better_than_one():
    radiance = (0.5 + 0.3 * D[..., 1:2] * np.array([1, 1.2, 1.5])).astype(np.float32)
    radiance[40, 100] = 2e4
    one, four, twelve = (fit_gaussians(radiance, count) for count in (1, 4, 12))
    assert np.degrees(angle_between(four.axes[0], D[40, 100])) < 0.5
    assert four.sharpness[0] > 5e3
    assert twelve.irradiance_error < 0.01 < four.irradiance_error < 0.1 < one.irradiance_error
    given = gaussians_irradiance(twelve, spread(256))
    wanted = irradiance(radiance, spread(256))
    error = np.sqrt(((given - wanted) ** 2).mean() / (wanted**2).mean())
    assert error == pytest.approx(twelve.irradiance_error, rel=1e-6)


def test_it_gives_the_same_lobes_each_time():
    radiance = evaluate_gaussians(TRUTH, D)
    np.testing.assert_array_equal(fit_gaussians(radiance, 5).axes, fit_gaussians(radiance, 5).axes)


def test_bad_calls_say_what_is_wrong():
    with pytest.raises(UsageError, match="lobe"):
        fit_gaussians(np.ones((8, 16, 3)), 0)
    with pytest.raises(ImageError, match="black"):
        fit_gaussians(np.zeros((8, 16, 3)), 2)

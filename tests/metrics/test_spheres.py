"""The three-sphere protocol on renders of four pixels, worked out by hand."""

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.metrics import lighting_of_spheres, sphere_errors


def render(*pixels: tuple[float, float, float, float]) -> np.ndarray:
    """A row of RGBA pixels."""
    return np.array([pixels], np.float64)


# Two pixels on the sphere, two transparent.
CLEAR = (0.0, 0.0, 0.0, 0.0)
TRUTH = render((1, 1, 1, 1), (2, 2, 2, 1), CLEAR, CLEAR)
ESTIMATE = render((1, 1, 1, 1), (2, 2, 3, 1), CLEAR, CLEAR)


def test_compat_rmse_sums_channels_and_divides_by_pixels():
    # One channel is off by 1: sqrt(1 / 2 pixels), not sqrt(1 / 6 samples).
    assert sphere_errors(ESTIMATE, TRUTH, "compat").rmse == pytest.approx(np.sqrt(1 / 2))
    assert sphere_errors(ESTIMATE, TRUTH, "fixed").rmse == pytest.approx(np.sqrt(1 / 6))


def test_compat_and_fixed_rmse_differ_by_the_square_root_of_three():
    random = np.random.default_rng(0)
    a, b = random.uniform(0.1, 1, (2, 8, 8, 4))
    a[..., 3] = b[..., 3] = 1
    published, corrected = sphere_errors(a, b, "compat"), sphere_errors(a, b, "fixed")
    assert published.rmse == pytest.approx(np.sqrt(3) * corrected.rmse)
    assert published.si_rmse == pytest.approx(np.sqrt(3) * corrected.si_rmse)
    assert published.angular_deg == pytest.approx(corrected.angular_deg)


def test_si_rmse_by_hand():
    # sum p^2 = 3 + 17, sum pg = 3 + 14, sum g^2 = 3 + 12: 15 - 17^2 / 20 = 0.55 over 2 pixels.
    assert sphere_errors(ESTIMATE, TRUTH, "compat").si_rmse == pytest.approx(np.sqrt(0.55 / 2))
    assert sphere_errors(ESTIMATE, TRUTH, "fixed").si_rmse == pytest.approx(np.sqrt(0.55 / 6))


def test_angle_by_hand():
    # (2, 2, 3) . (2, 2, 2) = 14 over sqrt(17 * 12); the other pixel agrees.
    angle = np.degrees(np.arccos(14 / np.sqrt(17 * 12)))
    assert sphere_errors(ESTIMATE, TRUTH, "compat").angular_deg == pytest.approx(angle / 2)
    assert sphere_errors(ESTIMATE, TRUTH, "fixed").angular_deg == pytest.approx(angle / 2)


def test_a_black_estimate_has_a_perfect_published_color_and_the_worst_corrected_one():
    black = render((0, 0, 0, 1), (0, 0, 0, 1), CLEAR, CLEAR)
    assert sphere_errors(black, TRUTH, "compat").angular_deg == 0
    assert sphere_errors(black, TRUTH, "fixed").angular_deg == 90


def test_compat_percentiles_are_over_the_whole_frame_and_a_hundredth_of_a_percent():
    def stretched(values: np.ndarray, all_values: np.ndarray, low_percent: float) -> np.ndarray:
        low, high = np.percentile(all_values, [low_percent, 99.9])
        return (values - low) / (high - low)

    p, g = ESTIMATE[0, :2, :3], TRUTH[0, :2, :3]
    frame = stretched(p, ESTIMATE[..., :3], 0.01) - stretched(g, TRUTH[..., :3], 0.01)
    published = sphere_errors(ESTIMATE, TRUTH, "compat").normalized_rmse
    assert published == pytest.approx(np.sqrt((frame**2).sum() / 2))
    inside = stretched(p, p, 0.1) - stretched(g, g, 0.1)
    corrected = sphere_errors(ESTIMATE, TRUTH, "fixed").normalized_rmse
    assert corrected == pytest.approx(np.sqrt((inside**2).mean()))
    assert corrected != pytest.approx(published / np.sqrt(3), rel=0.05)


def test_only_the_fixed_variant_weighs_a_pixel_at_the_rim_by_its_coverage():
    rim = render((1, 1, 1, 1), (5, 5, 5, 0.01))
    truth = render((1, 1, 1, 1), (1, 1, 1, 0.01))
    assert sphere_errors(rim, truth, "compat").rmse == pytest.approx(np.sqrt(3 * 16 / 2))
    assert sphere_errors(rim, truth, "fixed").rmse == pytest.approx(np.sqrt(16 * 0.01 / 1.01))


def test_tone_step_compresses_in_compat_and_not_in_fixed():
    radiance = np.ones((128, 256, 3), np.float32)
    radiance[60, 100] = 1e4
    published = lighting_of_spheres(radiance, "compat")
    assert np.median(published) == pytest.approx(0.5)
    assert published[60, 100, 0] / published[0, 0, 0] == pytest.approx(1e4 ** (1 / 2.4), rel=1e-5)
    corrected = lighting_of_spheres(radiance, "fixed")
    assert corrected[60, 100, 0] / corrected[0, 0, 0] == pytest.approx(1e4, rel=1e-5)
    assert np.median(corrected) == pytest.approx(0.5)


@pytest.mark.parametrize("variant", ["compat", "fixed"])
def test_tone_step_takes_the_scale_out_and_makes_one_size(variant):
    radiance = np.random.default_rng(2).lognormal(0, 1, (256, 512, 3)).astype(np.float32)
    toned = lighting_of_spheres(radiance, variant)
    assert toned.shape == (128, 256, 3)
    np.testing.assert_allclose(lighting_of_spheres(radiance * 9, variant), toned, rtol=1e-4)


def test_compat_averages_pixels_and_fixed_averages_solid_angle():
    radiance = np.ones((256, 512, 3), np.float32)
    radiance[0] = 3  # the upper of the two rows that become the pole's, a quarter of its area
    published, corrected = (lighting_of_spheres(radiance, v) for v in ("compat", "fixed"))
    assert published[0, 0, 0] / published[64, 0, 0] == pytest.approx(2 ** (1 / 2.4), rel=1e-4)
    assert corrected[0, 0, 0] / corrected[64, 0, 0] == pytest.approx(1.5, rel=1e-3)


def test_wrong_renders_are_refused():
    with pytest.raises(UsageError, match="transparent background"):
        sphere_errors(ESTIMATE[..., :3], TRUTH[..., :3])
    with pytest.raises(UsageError, match="'compat' or 'fixed'"):
        sphere_errors(ESTIMATE, TRUTH, "stylelight")  # type: ignore[arg-type]
    with pytest.raises(ImageError, match="Alpha is zero"):
        sphere_errors(TRUTH * 0, TRUTH)
    with pytest.raises(ImageError, match="EXR"):
        sphere_errors(ESTIMATE.astype(np.uint8), TRUTH.astype(np.uint8))
    with pytest.raises(ImageError, match="black map"):
        lighting_of_spheres(np.zeros((128, 256, 3), np.float32))

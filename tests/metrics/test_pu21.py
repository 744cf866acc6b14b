import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.metrics import pu21_crf_psnr, pu21_encode, pu21_psnr, pu21_psnr_y, pu21_ssim


def scene(seed: int = 0) -> np.ndarray:
    random = np.random.default_rng(seed)
    return random.lognormal(-1.5, 1, (32, 64, 3)).astype(np.float32)


def test_100_cd_m2_is_256_and_the_range_ends_where_published():
    assert pu21_encode(np.array([100.0]))[0] == pytest.approx(256, abs=0.5)
    assert pu21_encode(np.array([0.005]))[0] == pytest.approx(0, abs=0.5)
    assert pu21_encode(np.array([1e4]))[0] == pytest.approx(595.4, abs=1)
    assert pu21_encode(np.array([1e9]))[0] == pu21_encode(np.array([1e4]))[0]


def test_equal_maps_have_no_error():
    assert pu21_psnr(scene(), scene()) == float("inf")


def test_psnr_of_a_constant_offset_is_what_the_formula_says():
    truth = np.full((16, 32, 3), 1.0, np.float32)
    estimate = np.full((16, 32, 3), 0.5, np.float32)
    difference = pu21_encode(np.array([100.0]))[0] - pu21_encode(np.array([50.0]))[0]
    assert pu21_psnr(estimate, truth) == pytest.approx(20 * np.log10(256 / difference), abs=1e-3)


def test_the_correction_forgives_a_smooth_tone_curve_but_not_noise():
    truth = scene()
    curved = truth**1.3
    assert pu21_crf_psnr(curved, truth) > pu21_psnr(curved, truth) + 6
    noisy = truth * np.random.default_rng(1).lognormal(0, 0.5, truth.shape).astype(np.float32)
    assert pu21_crf_psnr(noisy, truth) < pu21_crf_psnr(curved, truth) - 6


def test_an_untouched_map_stays_near_perfect_after_the_correction():
    assert pu21_crf_psnr(scene(), scene()) > 50


def test_luminance_alone_forgives_color():
    truth = np.full((16, 32, 3), 0.5, np.float32)
    # Half the red for as much more green keeps the luminance that PU21 is taken of.
    shift = np.array([-0.25, 0.25 * 0.212656 / 0.715158, 0], np.float32)
    assert pu21_psnr_y(truth + shift, truth) > pu21_psnr(truth + shift, truth) + 40


def test_psnr_y_by_hand():
    truth = np.full((16, 32, 3), 1.0, np.float32)
    total = 100 * (0.212656 + 0.715158 + 0.072186)
    difference = np.subtract(*pu21_encode(np.array([total, total / 2])))
    expected = 20 * np.log10(256 / difference)
    assert pu21_psnr_y(truth / 2, truth) == pytest.approx(expected, abs=1e-3)


def test_ssim_is_of_encoded_luminance_with_a_range_of_256():
    truth = np.full((16, 32, 3), 1.0, np.float32)
    x, y = pu21_encode(np.array([50.0, 100.0]))
    c1 = (0.01 * 256) ** 2
    assert pu21_ssim(truth, truth) == pytest.approx(1)
    # Without variance only the means are left of the formula.
    assert pu21_ssim(truth / 2, truth) == pytest.approx(
        (2 * x * y + c1) / (x * x + y * y + c1), abs=1e-4
    )


@pytest.mark.parametrize("measure", [pu21_psnr, pu21_psnr_y, pu21_ssim, pu21_crf_psnr])
def test_what_cannot_be_compared_is_refused(measure):
    with pytest.raises(UsageError, match="resize_radiance"):
        measure(scene(), scene()[:16, :32])
    with pytest.raises(ImageError, match="not finite"):
        measure(scene() * np.float32(np.nan), scene())

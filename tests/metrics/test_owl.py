import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.metrics import score_owl

MASK = np.zeros((32, 32), bool)
MASK[4:28, 4:28] = True


def scene() -> np.ndarray:
    return np.random.default_rng(0).uniform(0.05, 0.9, (32, 32, 3))


def shown(linear: np.ndarray) -> np.ndarray:
    return np.clip(linear, 0, 1) ** (1 / 2.2)


@pytest.mark.parametrize("variant", ["compat", "fixed"])
def test_exposure_and_balance_are_found(variant):
    linear = scene()
    # Two stops under and tinted: 2^2 brings the exposure, 1 / tint the balance.
    tint = np.array([0.8, 1.0, 1.25])
    score = score_owl(linear / 4 * tint, shown(linear), MASK, variant)
    total = 2**score.exposure_stops * score.balance
    assert total == pytest.approx(4 / tint, rel=2e-2)
    assert score.psnr_db > 35


def test_the_fixed_fit_is_exact_and_at_least_as_good():
    linear = scene()
    estimate = linear / 4 * [0.8, 1.0, 1.25]
    compat = score_owl(estimate, shown(linear), MASK, "compat")
    fixed = score_owl(estimate, shown(linear), MASK, "fixed")
    assert fixed.psnr_db > 60
    assert fixed.psnr_db >= compat.psnr_db
    assert 2**fixed.exposure_stops * fixed.balance == pytest.approx([5, 4, 3.2], rel=1e-4)


def test_without_balance_a_tint_stays():
    linear = scene()
    score = score_owl(linear * [0.6, 1, 1.6], shown(linear), MASK, balance_colors=False)
    assert score.balance.tolist() == [1, 1, 1]
    assert score.psnr_db < 25


def test_overexposed_pixels_do_not_decide_the_exposure():
    linear = scene()
    truth, estimate = shown(linear), linear.copy()
    truth[8:16, 8:16] = 1
    estimate[8:16, 8:16] = 1e-3  # wrong, where the truth says nothing
    score = score_owl(estimate, truth, MASK)
    assert score.exposure_stops == pytest.approx(0, abs=1e-4)


def test_psnr_by_hand():
    # Equal but for one of 24x24 pixels, a channel of which is off by a tenth.
    linear = scene()
    truth = shown(linear)
    estimate = linear.copy()
    estimate[10, 10, 0] = (truth[10, 10, 0] - 0.1) ** 2.2
    score = score_owl(estimate, truth, MASK, balance_colors=False)
    assert score.psnr_db == pytest.approx(10 * np.log10(24 * 24 * 3 / 0.01), abs=1e-2)


def test_published_ssim_flatters_the_outline():
    linear = scene()
    noisy = linear * np.random.default_rng(1).uniform(0.5, 1.5, linear.shape)
    compat = score_owl(noisy, shown(linear), MASK, "compat")
    fixed = score_owl(noisy, shown(linear), MASK, "fixed")
    assert compat.ssim > fixed.ssim


def test_wrong_input_is_refused():
    linear = scene()
    with pytest.raises(ImageError, match=r"\[0, 1\]"):
        score_owl(linear, linear * 9, MASK)
    with pytest.raises(ImageError, match="no exposure"):
        score_owl(linear * 0, shown(linear), MASK)
    with pytest.raises(ImageError, match="no exposure"):
        score_owl(linear, np.ones_like(linear), MASK)
    with pytest.raises(UsageError, match="mask"):
        score_owl(linear, shown(linear), MASK[:8])
    with pytest.raises(UsageError, match="variant"):
        score_owl(linear, shown(linear), MASK, "owl")  # type: ignore[arg-type]

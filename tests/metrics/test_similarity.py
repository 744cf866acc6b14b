"""SSIM against its definition evaluated window by window, and against cases worked out by hand."""

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.metrics.similarity import PRESETS, SsimSettings, dssim, dssim_of_maps, encode, ssim


def pictures(height: int = 20, width: int = 40) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(4)
    truth = random.uniform(0, 1, (height, width, 3))
    return np.clip(truth + random.normal(0, 0.2, truth.shape), 0, 1), truth


def one_window(x: np.ndarray, y: np.ndarray, weights: np.ndarray, unbias: float, span: float):
    """Equation 13 of Wang et al. 2004 for one window of one channel."""
    mean_x, mean_y = (weights * x).sum(), (weights * y).sum()
    var_x = unbias * ((weights * x * x).sum() - mean_x**2)
    var_y = unbias * ((weights * y * y).sum() - mean_y**2)
    both = unbias * ((weights * x * y).sum() - mean_x * mean_y)
    c1, c2 = (0.01 * span) ** 2, (0.03 * span) ** 2
    return ((2 * mean_x * mean_y + c1) * (2 * both + c2)) / (
        (mean_x**2 + mean_y**2 + c1) * (var_x + var_y + c2)
    )


def over_windows(x: np.ndarray, y: np.ndarray, weights: np.ndarray, unbias: float, span: float):
    size = len(weights)
    values = [
        one_window(
            x[row : row + size, column : column + size, channel],
            y[row : row + size, column : column + size, channel],
            weights,
            unbias,
            span,
        )
        for row in range(x.shape[0] - size + 1)
        for column in range(x.shape[1] - size + 1)
        for channel in range(3)
    ]
    return np.mean(values)


def test_thesis_preset_is_uniform_sample_covariance_and_range_two():
    estimate, truth = pictures()
    expected = over_windows(estimate, truth, np.full((7, 7), 1 / 49), 49 / 48, 2.0)
    assert ssim(estimate, truth, "thesis") == pytest.approx(expected, abs=1e-10)


def test_wang_preset_is_eleven_gaussian_taps_and_range_one():
    estimate, truth = pictures()
    taps = np.exp(-(np.arange(-5, 6) ** 2) / (2 * 1.5**2))
    weights = np.outer(taps, taps) / taps.sum() ** 2
    expected = over_windows(estimate, truth, weights, 1.0, 1.0)
    assert ssim(estimate, truth, "wang") == pytest.approx(expected, abs=1e-10)


def test_constant_pictures_by_hand():
    # No variance: (2 * 0.5 * 0.7 + C1) / (0.25 + 0.49 + C1) * C2 / C2 with C1 = 1e-4.
    a, b = np.full((16, 32, 3), 0.5), np.full((16, 32, 3), 0.7)
    by_hand = (0.7 + 1e-4) / (0.74 + 1e-4)
    assert ssim(a, b, "wang") == pytest.approx(by_hand)
    assert ssim(a, b, "sphere") == pytest.approx(by_hand)
    assert dssim(a, b, "wang") == pytest.approx((1 - by_hand) / 2)
    assert ssim(a, b, "thesis") == pytest.approx((0.7 + 4e-4) / (0.74 + 4e-4))


def test_only_the_sphere_preset_sees_a_difference_at_the_seam_from_both_sides():
    truth = np.full((20, 40, 3), 0.5)
    at_seam, inside = truth.copy(), truth.copy()
    at_seam[8:12, [0, 1, -2, -1]] = 1
    inside[8:12, 18:22] = 1
    assert ssim(at_seam, truth, "sphere") == pytest.approx(ssim(inside, truth, "sphere"))
    assert ssim(at_seam, truth, "wang") > ssim(inside, truth, "wang")


def test_a_difference_at_the_pole_counts_less_on_the_sphere():
    truth = np.full((32, 64, 3), 0.5)
    pole, horizon = truth.copy(), truth.copy()
    pole[2:4, 30:34] = 1
    horizon[15:17, 30:34] = 1
    assert dssim(pole, truth, "sphere") < 0.5 * dssim(horizon, truth, "sphere")


def test_settings_alone_move_the_score():
    # Dim pictures: the constants of a range of 2 hide most of their difference.
    estimate, truth = (0.05 * picture for picture in pictures())
    scores = {name: dssim(estimate, truth, name) for name in PRESETS}
    assert scores["thesis"] < 0.8 * scores["wang"]


def test_encodings_have_the_ends_they_say():
    radiance = np.array([0.0, 1.0, 1e4])
    assert encode(radiance, "log") == pytest.approx([0, np.log(2) / np.log(10001), 1])
    assert encode(radiance, "srgb") == pytest.approx([0, 1, 1])
    assert encode(radiance, "linear") is radiance
    with pytest.raises(UsageError, match="'pq'"):
        encode(radiance, "pq")  # type: ignore[arg-type]


def test_maps_are_encoded_before_they_are_compared():
    random = np.random.default_rng(1)
    truth = random.lognormal(0, 2, (32, 64, 3))
    estimate = truth * 1.2
    expected = dssim(encode(estimate, "log"), encode(truth, "log"), "thesis")
    assert dssim_of_maps(estimate, truth, preset="thesis", encoding="log") == expected


def test_wrong_input_is_refused():
    estimate, truth = pictures()
    with pytest.raises(UsageError, match="presets are thesis"):
        ssim(estimate, truth, "skimage")  # type: ignore[arg-type]
    with pytest.raises(UsageError, match=r"\(H, W, C\)"):
        ssim(estimate[:10], truth, "wang")
    with pytest.raises(ImageError, match="Divide"):
        ssim((estimate * 255).astype(np.uint8), (truth * 255).astype(np.uint8), "wang")
    with pytest.raises(ImageError, match="11 px"):
        ssim(estimate[:8, :16], truth[:8, :16], "wang")
    assert ssim(
        truth,
        truth,
        SsimSettings(window_px=3, sigma_px=None, sample_covariance=False, data_range=1),
    ) == pytest.approx(1)

"""Plain differences, against values computed by hand on maps of two pixels' rows."""

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.metrics import (
    l1,
    log_rmse,
    mse,
    psnr_db,
    relative_l1,
    rgb_angular_deg,
    rmse,
    si_rmse,
    ssd,
)

# 4x4, the anamorphic form. Rows of 45 degrees cover (1 - cos 45) / 4 = 0.0732 of the sphere
# each at the poles and cos 45 / 4 = 0.1768 at the horizon, so shares of all are:
POLE, MIDDLE = (1 - np.sqrt(0.5)) / 2, np.sqrt(0.5) / 2


def rows(*values: float) -> np.ndarray:
    """A 4x4 map with one grey value in each row."""
    return np.array(values, np.float32)[:, None, None].repeat(4, 1).repeat(3, 2)


def test_a_difference_at_the_pole_counts_by_what_the_row_covers():
    truth, estimate = rows(1, 1, 1, 1), rows(3, 1, 1, 1)
    assert l1(estimate, truth) == pytest.approx(2 * POLE)
    assert l1(estimate, truth, weighting="pixel") == pytest.approx(2 / 4)
    assert mse(estimate, truth) == pytest.approx(4 * POLE)
    assert rmse(estimate, truth) == pytest.approx(np.sqrt(4 * POLE))
    # 4 pixels of 3 channels are off by 2.
    assert ssd(estimate, truth, weighting="pixel") == pytest.approx(4 * 3 * 4)
    assert ssd(estimate, truth) == pytest.approx(48 * 4 * POLE)


def test_relative_l1_is_over_the_mean_of_the_truth():
    truth, estimate = rows(2, 4, 4, 2), rows(2, 5, 4, 2)
    assert relative_l1(estimate, truth) == pytest.approx(MIDDLE / (2 * 2 * POLE + 2 * 4 * MIDDLE))
    assert relative_l1(truth * 0, truth) == pytest.approx(1)
    assert np.isnan(relative_l1(truth, truth * 0))


def test_log_rmse_is_in_decades_and_stops_at_its_floor():
    truth, estimate = rows(1, 1, 1, 1), rows(1, 100, 1, 1)
    assert log_rmse(estimate, truth) == pytest.approx(np.sqrt(4 * MIDDLE))
    assert log_rmse(rows(1, 1e-9, 1, 1), truth, floor=0.1) == pytest.approx(np.sqrt(MIDDLE))
    # The truth's mean is 1, so the floor is a thousandth: three decades.
    assert log_rmse(rows(0, 0, 0, 0), truth) == pytest.approx(3)
    with pytest.raises(UsageError, match="floor"):
        log_rmse(truth, truth * 0)


def test_si_rmse_takes_one_factor_out_or_one_for_each_channel():
    truth = rows(1, 2, 2, 1)
    tinted = truth * np.array([2, 3, 4], np.float32)
    assert si_rmse(truth * 7, truth) == pytest.approx(0, abs=1e-6)
    assert si_rmse(tinted, truth, per_channel=True) == pytest.approx(0, abs=1e-6)
    # alpha = (2 + 3 + 4) / (4 + 9 + 16) = 9/29; what is left of each channel is 1 - alpha k.
    left = np.mean([(1 - 9 / 29 * k) ** 2 for k in (2, 3, 4)])
    power = 2 * POLE + 2 * 4 * MIDDLE
    assert si_rmse(tinted, truth) == pytest.approx(np.sqrt(left * power))
    assert si_rmse(truth * 0, truth) == pytest.approx(np.sqrt(power))


def test_psnr_needs_its_peak():
    truth, estimate = rows(1, 1, 1, 1), rows(1.1, 1.1, 1.1, 1.1)
    assert psnr_db(estimate, truth, peak=1) == pytest.approx(20, abs=1e-4)
    assert psnr_db(estimate, truth, peak=10) == pytest.approx(40, abs=1e-4)
    assert psnr_db(truth, truth, peak=1) == float("inf")
    with pytest.raises(UsageError, match="peak"):
        psnr_db(truth, truth, peak=0)


def test_rgb_angles_count_black_against_a_color_as_the_widest():
    red, grey = rows(1, 1, 1, 1) * np.array([1, 0, 0], np.float32), rows(1, 1, 1, 1)
    assert rgb_angular_deg(grey, red) == pytest.approx(np.degrees(np.arccos(1 / np.sqrt(3))))
    assert rgb_angular_deg(rows(0, 5, 5, 5), grey) == pytest.approx(90 * POLE)
    # Black in both says nothing: the mean is over the other rows.
    assert rgb_angular_deg(rows(0, 0, 5, 5), rows(0, 1, 1, 1)) == pytest.approx(
        90 * MIDDLE / (1 - POLE)
    )
    assert np.isnan(rgb_angular_deg(grey * 0, grey * 0))


def test_maps_that_cannot_be_compared_are_refused():
    good = rows(1, 1, 1, 1)
    with pytest.raises(UsageError, match="resize_radiance"):
        mse(np.ones((8, 16, 3), np.float32), good)
    with pytest.raises(ImageError, match="uint8") as caught:
        mse(good.astype(np.uint8), good.astype(np.uint8))
    assert caught.value.reason == "wrong-dtype"
    broken = good.copy()
    broken[0, 0, 0] = np.nan
    with pytest.raises(ImageError, match="1 values"):
        mse(broken, good)
    with pytest.raises(ImageError) as caught:
        mse(np.ones((4, 6, 3)), np.ones((4, 6, 3)))
    assert caught.value.reason == "not-equirectangular"
    with pytest.raises(ImageError) as caught:
        mse(np.ones((0, 0, 3)), np.ones((0, 0, 3)))
    assert caught.value.reason == "wrong-channels"
    with pytest.raises(UsageError, match="weighting"):
        mse(good, good, weighting="area")  # type: ignore[arg-type]

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.metrics import array_errors, display_panel, median_array_errors
from panokit.metrics.sphere_array import ArrayErrors

TRUTH = np.array([[[1, 1, 1], [2, 2, 2]]], np.float32)
ESTIMATE = np.array([[[1, 1, 1], [2, 2, 3]]], np.float32)


@pytest.mark.parametrize("variant", ["compat", "fixed"])
def test_by_hand(variant):
    errors = array_errors(ESTIMATE, TRUTH, variant)
    assert errors.rmse == pytest.approx(np.sqrt(1 / 6))
    # g.p = 17 and p.p = 20, so what is left of g.g = 15 is 15 - 17^2 / 20.
    assert errors.si_rmse == pytest.approx(np.sqrt(0.55 / 6))


def test_the_published_peak_is_of_either_image():
    assert array_errors(ESTIMATE, TRUTH, "compat").psnr_db == pytest.approx(
        20 * np.log10(3 / np.sqrt(1 / 6))
    )
    assert array_errors(ESTIMATE, TRUTH, "fixed").psnr_db == pytest.approx(
        20 * np.log10(2 / np.sqrt(1 / 6))
    )


def test_a_firefly_improves_the_published_psnr_against_what_it_costs():
    truth = np.ones((64, 64, 3), np.float32)
    wrong = truth * 0.5
    firefly = wrong.copy()
    firefly[0, 0] = 20
    assert array_errors(firefly, truth, "compat").psnr_db > array_errors(wrong, truth).psnr_db + 20
    assert array_errors(firefly, truth, "fixed").psnr_db < array_errors(wrong, truth).psnr_db


def test_black_pixels_of_the_estimate_cost_nothing_as_published():
    truth = np.ones((2, 2, 3), np.float32)
    half_black = truth.copy()
    half_black[0] = 0
    assert array_errors(half_black, truth, "compat").angular_deg == pytest.approx(0, abs=1e-5)
    assert array_errors(half_black, truth, "fixed").angular_deg == pytest.approx(45)


def test_equal_renders():
    assert array_errors(TRUTH, TRUTH, "compat").psnr_db == 100
    assert array_errors(TRUTH, TRUTH, "fixed").psnr_db == float("inf")
    assert array_errors(TRUTH, TRUTH).to_json()["psnr_db"] is None


def test_the_figure_of_a_table_is_the_median_over_scenes():
    scenes = [
        ArrayErrors(rmse=r, si_rmse=r / 2, angular_deg=a, psnr_db=30)
        for r, a in ((1, 5.0), (2, float("nan")), (9, 7.0))
    ]
    found = median_array_errors(scenes)
    assert (found.rmse, found.si_rmse, found.angular_deg) == (2, 1, 6)
    with pytest.raises(UsageError, match="one scene"):
        median_array_errors([])


def test_the_panel_shows_the_90th_percentile_at_four_fifths():
    render = np.full((10, 10, 3), 3.0, np.float32)
    assert display_panel(render)[0, 0, 0] == int(0.8 ** (1 / 2.2) * 255)


def test_wrong_renders_are_refused():
    with pytest.raises(UsageError, match="one size"):
        array_errors(TRUTH, np.ones((4, 4, 3), np.float32))
    with pytest.raises(ImageError, match=r"\(H, W, 3\)"):
        array_errors(TRUTH[..., 0], TRUTH[..., 0])
    with pytest.raises(ImageError, match="EXR"):
        array_errors(TRUTH.astype(np.uint8), TRUTH)
    with pytest.raises(UsageError, match="variant"):
        array_errors(TRUTH, TRUTH, "median")  # type: ignore[arg-type]

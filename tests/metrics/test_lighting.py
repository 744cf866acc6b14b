import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.metrics import (
    beyond_clip_ratio,
    energy_ratio,
    irradiance_errors,
    light_vector_error_deg,
    peak_direction,
    peak_error_deg,
)
from panokit.metrics.pairs import check_same_shape
from panokit.sphere import equirect_directions


def lit(row: int, column: int, value: float = 100.0) -> np.ndarray:
    radiance = np.full((64, 128, 3), 0.1, np.float32)
    radiance[row, column] = value
    return radiance


def test_a_map_has_no_error_against_itself():
    radiance = lit(20, 40)
    assert energy_ratio(radiance, radiance) == 1
    assert beyond_clip_ratio(radiance, radiance) == 1
    assert not irradiance_errors(radiance, radiance).any()
    assert light_vector_error_deg(radiance, radiance) == pytest.approx(0, abs=1e-4)
    assert peak_error_deg(radiance, radiance) == pytest.approx(0, abs=1e-4)


def test_twice_the_light_is_an_energy_ratio_of_two_and_an_error_of_one_on_each_axis():
    radiance = lit(20, 40)
    assert energy_ratio(2 * radiance, radiance) == pytest.approx(2)
    assert irradiance_errors(2 * radiance, radiance) == pytest.approx(np.ones(6))
    assert light_vector_error_deg(2 * radiance, radiance) == pytest.approx(0, abs=1e-4)


def test_only_light_beyond_the_clip_level_counts_in_its_ratio():
    truth = lit(20, 40, value=50)
    clipped = np.minimum(truth, 1)
    assert beyond_clip_ratio(clipped, truth) == pytest.approx(1 / 50)
    assert np.isnan(beyond_clip_ratio(clipped, clipped))


def test_a_lamp_turned_by_90_degrees_turns_light_vector_and_peak_by_90():
    at_horizon, turned = lit(32, 40, 1e5), lit(32, 40 + 32, 1e5)
    assert light_vector_error_deg(turned, at_horizon) == pytest.approx(90, abs=3)
    assert peak_error_deg(turned, at_horizon) == pytest.approx(90, abs=0.5)


def test_the_peak_is_found_across_the_seam_and_between_ties():
    seam = lit(30, 0)
    seam[30, 127] = 100
    expected = equirect_directions(128, 64)[30, [0, 127]].mean(axis=0)
    assert np.dot(peak_direction(seam), expected / np.linalg.norm(expected)) > 0.9999


def test_irradiance_error_of_missing_side_light_is_on_that_side():
    truth = lit(32, 96, 1e4)  # azimuth +90 degrees: +x
    errors = irradiance_errors(np.minimum(truth, 1), truth)
    assert errors[0] > 0.9
    assert errors[1] < 1e-3


def test_maps_of_different_sizes_are_refused():
    with pytest.raises(UsageError, match="resize_radiance"):
        check_same_shape(np.zeros((8, 16, 3)), np.zeros((16, 32, 3)))


@pytest.mark.parametrize(
    "measure",
    [energy_ratio, beyond_clip_ratio, irradiance_errors, light_vector_error_deg, peak_error_deg],
)
def test_what_is_no_radiance_is_refused(measure):
    good = lit(20, 40)
    for wrong, words in (
        (good.astype(np.uint8), "uint8"),
        (good[..., :1], "RGB"),
        (good[:, :90], "2:1"),
        (good * np.float32(np.inf), "not finite"),
    ):
        with pytest.raises(ImageError, match=words):
            measure(wrong, good)

import numpy as np
import pytest

from panokit.metrics import irradiance_axis_errors, irradiance_sh_error
from panokit.sphere import irradiance_map, pixel_solid_angles


def lit(row: int, column: int, value: float = 50.0) -> np.ndarray:
    radiance = np.full((64, 128, 3), 0.2, np.float32)
    radiance[row - 2 : row + 2, column - 2 : column + 2] = value
    return radiance


def test_nine_numbers_say_what_all_normals_receive():
    estimate, truth = lit(30, 40), lit(20, 70)
    received, true = irradiance_map(estimate, 64), irradiance_map(truth, 64)
    weights = pixel_solid_angles(32, 64)[..., None]
    over_normals = np.sqrt((weights * (received - true) ** 2).sum() / (weights * true**2).sum())
    assert irradiance_sh_error(estimate, truth) == pytest.approx(over_normals, rel=0.02)


def test_a_wrong_scale_is_a_relative_error_of_the_same_size():
    truth = lit(20, 70)
    assert irradiance_sh_error(truth, truth) == 0
    assert irradiance_sh_error(1.25 * truth, truth) == pytest.approx(0.25, rel=1e-5)
    assert irradiance_sh_error(0 * truth, truth) == pytest.approx(1)
    assert np.isnan(irradiance_sh_error(truth, 0 * truth))


def test_axes_have_a_mean_and_a_largest_error():
    truth = lit(32, 96, 1e4)
    errors = irradiance_axis_errors(np.minimum(truth, 1), truth)
    assert errors.max > 0.9
    assert 0.1 < errors.mean < errors.max

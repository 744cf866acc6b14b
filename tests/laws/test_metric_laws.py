"""What every measure of light must obey, whatever the maps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from panokit.frames import Rotation
from panokit.metrics import (
    brightest_deg,
    brightest_px,
    dominance_ratio,
    dssim_of_maps,
    energy_ratio,
    find_light_blobs,
    irradiance_sh_error,
    l1,
    light_direction_error_deg,
    light_vector_error_deg,
    log_rmse,
    mse,
    peak_error_deg,
    psnr_db,
    relative_l1,
    rgb_angular_deg,
    rmse,
    si_rmse,
    ssd,
    sun_energy_stops,
)
from panokit.sphere import equirect_directions, rotate_radiance


def with_sun(radiance: np.ndarray) -> np.ndarray:
    """Without a sun the directions of light vector and peak are those of noise."""
    radiance[5, 9] = 1e4
    return radiance


radiances = arrays.arrays(
    np.float32, (16, 32, 3), elements=st.floats(0.015625, 64, width=32), fill=st.just(0.5)
).map(with_sun)
DISTANCES = [l1, mse, rmse, ssd, log_rmse, si_rmse, relative_l1, irradiance_sh_error]
SYMMETRIC = [l1, mse, rmse, ssd]
# Powers of two, which scale without rounding: ties of the brightest pixel stay ties.
scales = st.integers(-6, 6).map(lambda power: 2.0**power)


def smooth_scene(seed: int, lamp: tuple[float, float, float], width: int = 128) -> np.ndarray:
    """A sky of low frequencies with a soft lamp, which resampling hardly changes."""
    directions = equirect_directions(width, width // 2)
    random = np.random.default_rng(seed)
    waves = np.sin(2 * directions @ random.normal(size=(3, 3)) + random.uniform(0, 6, 3))
    glow = np.exp(12 * (directions @ (np.array(lamp) / np.linalg.norm(lamp)) - 1))
    return (0.6 + 0.3 * waves + 4 * glow[..., None]).astype(np.float32)


@settings(deadline=None, max_examples=25)
@given(radiances)
def test_identity_scores_perfectly(radiance):
    for distance in DISTANCES:
        assert distance(radiance, radiance) == pytest.approx(0, abs=1e-5)
    for angle in (rgb_angular_deg, brightest_deg, light_vector_error_deg, peak_error_deg):
        assert angle(radiance, radiance) == pytest.approx(0, abs=1e-3)
    assert brightest_px(radiance, radiance) == 0
    assert psnr_db(radiance, radiance, peak=1) == float("inf")
    assert energy_ratio(radiance, radiance) == 1
    assert sun_energy_stops(radiance, radiance) == 0
    assert dssim_of_maps(radiance, radiance, preset="sphere", encoding="log") == pytest.approx(0)


@settings(deadline=None, max_examples=25)
@given(radiances, radiances)
def test_differences_are_symmetric_where_they_should_be(a, b):
    for distance in SYMMETRIC:
        assert distance(a, b) == pytest.approx(distance(b, a))
    for angle in (rgb_angular_deg, brightest_deg, light_vector_error_deg):
        assert angle(a, b) == pytest.approx(angle(b, a), abs=1e-6)
    assert log_rmse(a, b, floor=1e-3) == pytest.approx(log_rmse(b, a, floor=1e-3))
    assert dssim_of_maps(a, b, preset="thesis", encoding="log") == pytest.approx(
        dssim_of_maps(b, a, preset="thesis", encoding="log")
    )


@settings(deadline=None, max_examples=25)
@given(radiances, radiances, scales)
def test_scale_of_the_estimate_leaves_scale_free_figures_alone(estimate, truth, scale):
    louder = (estimate * np.float32(scale)).astype(np.float32)
    for figure in (si_rmse, rgb_angular_deg, light_vector_error_deg, brightest_deg):
        assert figure(louder, truth) == pytest.approx(figure(estimate, truth), rel=1e-3, abs=2e-3)
    assert si_rmse(estimate, truth) <= rmse(estimate, truth) * (1 + 1e-9)
    assert si_rmse(estimate, truth, per_channel=True) <= si_rmse(estimate, truth) * (1 + 1e-9)
    assert dominance_ratio(louder) == pytest.approx(dominance_ratio(estimate), rel=1e-3)


@settings(deadline=None, max_examples=25)
@given(radiances, radiances, scales)
def test_linear_errors_scale_with_both_maps(estimate, truth, scale):
    factor = np.float32(scale)
    for distance, power in ((l1, 1), (rmse, 1), (mse, 2), (si_rmse, 1), (relative_l1, 0)):
        scaled = distance(estimate * factor, truth * factor)
        assert scaled == pytest.approx(
            distance(estimate, truth) * float(factor) ** power, rel=1e-3, abs=1e-6
        )


@settings(deadline=None, max_examples=15)
@given(st.integers(0, 31), radiances, radiances)
def test_a_roll_of_both_maps_changes_nothing_that_counts_solid_angle(columns, a, b):
    turned = np.roll(a, columns, axis=1), np.roll(b, columns, axis=1)
    for distance in DISTANCES:
        assert distance(*turned) == pytest.approx(distance(a, b), rel=1e-4, abs=1e-6)
    assert dssim_of_maps(*turned, preset="sphere", encoding="log") == pytest.approx(
        dssim_of_maps(a, b, preset="sphere", encoding="log"), abs=1e-6
    )


@settings(deadline=None, max_examples=10)
@given(
    st.tuples(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-3, 3)).map(
        lambda angles: Rotation.from_heading_pitch_roll(*angles)
    ),
    st.integers(0, 5),
)
def test_a_rotation_of_both_maps_changes_little(rotation, seed):
    a, b = smooth_scene(seed, (1, 0.6, -0.5)), smooth_scene(seed + 9, (0.8, 0.7, -0.6))
    turned = rotate_radiance(a, rotation), rotate_radiance(b, rotation)
    for distance in (l1, mse, log_rmse, si_rmse, irradiance_sh_error):
        assert distance(*turned) == pytest.approx(distance(a, b), rel=0.02)
    for angle in (rgb_angular_deg, light_vector_error_deg):
        assert angle(*turned) == pytest.approx(angle(a, b), rel=0.02, abs=0.2)
    # Lights are found on pixels, so their angle may move by a part of one.
    assert light_direction_error_deg(*turned) == pytest.approx(
        light_direction_error_deg(a, b), abs=1.5
    )
    assert len(find_light_blobs(turned[0])) == len(find_light_blobs(a))


def test_a_row_at_the_pole_weighs_less_than_one_at_the_horizon():
    truth = np.ones((32, 64, 3), np.float32)
    pole, horizon = truth.copy(), truth.copy()
    pole[0], horizon[15] = 2, 2
    assert mse(pole, truth) < 0.1 * mse(horizon, truth)
    assert mse(pole, truth, weighting="pixel") == mse(horizon, truth, weighting="pixel")


@given(st.integers(0, 63), st.integers(1, 32))
@settings(deadline=None, max_examples=20)
def test_a_roll_by_columns_is_that_many_pixels_and_5_625_degrees_each(start, columns):
    # 64 columns of 5.625 degrees; 64 rows, so the row next to the horizon is 1.4 degrees off.
    truth = np.full((64, 64, 3), 0.1, np.float32)
    truth[31, start] = 9
    estimate = np.roll(truth, columns, axis=1)
    assert brightest_px(estimate, truth) == columns
    assert brightest_px(np.roll(truth, 1, axis=1), truth) == 1
    assert brightest_deg(np.roll(truth, 1, axis=1), truth) == pytest.approx(5.625, abs=0.003)
    if columns <= 16:
        assert brightest_deg(estimate, truth) == pytest.approx(5.625 * columns, abs=0.05)

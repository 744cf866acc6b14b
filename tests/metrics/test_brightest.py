import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.io import read_environment_map
from panokit.metrics import brightest_deg, brightest_px, dominance_ratio, has_dominant_light


def lamp(row: int, column: int, color=(1.0, 1.0, 1.0), size: int = 64) -> np.ndarray:
    radiance = np.full((size, size, 3), 0.01, np.float32)
    radiance[row, column] = color
    return radiance


def test_pixels_are_counted_flat_wrapped_and_doubly_wrapped():
    a, b = lamp(1, 2), lamp(61, 62)
    assert brightest_px(a, b, wrap="none") == pytest.approx(np.hypot(60, 60))
    assert brightest_px(a, b, wrap="columns") == pytest.approx(np.hypot(60, 4))
    assert brightest_px(a, b, wrap="both") == pytest.approx(np.hypot(4, 4))


def test_the_largest_distances_on_64x64_are_those_that_tell_the_readings_apart():
    corner, opposite = lamp(0, 0), lamp(63, 63)
    assert brightest_px(corner, opposite, wrap="none") == pytest.approx(89.1, abs=0.05)
    assert brightest_px(corner, lamp(63, 32), wrap="columns") == pytest.approx(70.6, abs=0.1)
    assert brightest_px(corner, lamp(32, 32), wrap="both") == pytest.approx(45.25, abs=0.01)


def test_the_mean_over_channels_can_be_a_third_of_a_pixel():
    # Blue is brightest one column further; red and green agree.
    truth = lamp(20, 30)
    estimate = truth.copy()
    estimate[20, 31] = [0.5, 0.5, 1.5]
    assert brightest_px(estimate, truth, reading="rgb-mean") == pytest.approx(1 / 3)
    assert brightest_px(estimate, truth, reading="luma") == 0


def test_degrees_are_of_the_great_circle():
    a = np.full((32, 64, 3), 0.1)
    b = a.copy()
    a[15, 10], b[15, 42] = 9, 9  # 180 degrees of azimuth at an elevation of 2.8125
    assert brightest_deg(a, b) == pytest.approx(180 - 2 * 2.8125, abs=1e-4)
    assert brightest_deg(a, a) == pytest.approx(0, abs=1e-4)


def test_a_uniform_map_has_no_dominant_light():
    assert dominance_ratio(np.full((32, 64, 3), 2.0, np.float32)) == pytest.approx(1, rel=1e-3)
    assert dominance_ratio(np.zeros((32, 64, 3), np.float32)) == 1


def test_a_sun_dominates_and_two_equal_lamps_do_not():
    sky = np.full((64, 128, 3), 0.1, np.float32)
    sun, lamps = sky.copy(), sky.copy()
    sun[20, 30] = 5e3
    lamps[20, [30, 94]] = 5e3
    assert dominance_ratio(sun) > 20
    assert has_dominant_light(sun)
    assert dominance_ratio(lamps) == pytest.approx(1, rel=0.02)
    assert not has_dominant_light(lamps)
    assert dominance_ratio(sun * 77) == pytest.approx(dominance_ratio(sun), rel=1e-4)


def test_a_lone_lamp_in_the_dark_dominates_beyond_measure():
    alone = np.zeros((32, 64, 3), np.float32)
    alone[10, 10] = 1
    assert dominance_ratio(alone) == float("inf")


@pytest.mark.data
@pytest.mark.parametrize(
    ("name", "dominant"),
    [
        ("kloofendal_overcast_1k", False),
        ("vestibule_1k", False),
        ("pmndrs_venice_1k", False),
        ("kloofendal_43d_clear_puresky_1k", True),
        ("quarry_01_1k", True),
    ],
)
def test_real_skies_and_rooms_fall_on_the_right_side(shared_data, name, dominant):
    radiance = read_environment_map(shared_data / "probes" / f"{name}.hdr").radiance
    assert has_dominant_light(radiance) == dominant


def test_wrong_names_are_refused():
    with pytest.raises(UsageError, match="rgb-mean"):
        brightest_px(lamp(1, 1), lamp(1, 1), reading="max")  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="wraps"):
        brightest_px(lamp(1, 1), lamp(1, 1), wrap="rows")  # type: ignore[arg-type]

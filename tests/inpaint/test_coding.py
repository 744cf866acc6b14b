import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.inpaint.coding import DisplayCoding, LogCoding


@settings(max_examples=50, deadline=None)
@given(
    median=st.floats(1e-4, 1e4),
    values=st.lists(st.floats(0, 1e8, width=32), min_size=3, max_size=30),
)
def test_radiance_comes_back_as_it_was(median, values):
    coding = LogCoding.around(np.full((4, 3), median, np.float32))
    radiance = np.array(values, np.float32)
    back = coding.decode(coding.encode(radiance))
    assert back.dtype == np.float32
    assert np.allclose(back, radiance, rtol=2e-4, atol=median * 1e-5)


def test_surroundings_are_mid_gray_and_a_sun_is_within_reach():
    coding = LogCoding.around(np.full((4, 3), 0.02, np.float32))
    levels = coding.encode(np.array([0, 0.02, 0.02 * 1e5], np.float32))
    assert levels[0] == 0
    assert levels[1] == pytest.approx(110, abs=1)
    assert levels[2] < 700


def test_one_bright_neighbor_does_not_outweigh_the_others():
    coding = LogCoding.around(np.full((9, 3), 1.0, np.float32))
    mixed = coding.encode(np.array([1.0] * 9 + [1000.0], np.float32)).mean()
    assert coding.decode(np.float32(mixed)) < 3


def test_surroundings_without_light_are_allowed():
    coding = LogCoding.around(np.zeros((5, 3), np.float32))
    assert np.array_equal(coding.decode(coding.encode(np.zeros(3, np.float32))), np.zeros(3))


def test_8_bit_levels_are_rounded_and_stay_8_bit():
    decoded = DisplayCoding().decode(np.array([-3, 0.4, 99.6, 300], np.float32))
    assert decoded.dtype == np.uint8
    assert decoded.tolist() == [0, 0, 100, 255]

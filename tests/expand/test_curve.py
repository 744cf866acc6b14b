import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.color import srgb_decode
from panokit.color.camera import sigmoid_encode
from panokit.expand.curve import apply_curve

slopes = st.floats(0.4, 2.5)


def test_equal_slopes_of_one_change_nothing():
    linear = np.linspace(0.001, 1, 50, dtype=np.float32)
    assert apply_curve(linear, 1, 1) == pytest.approx(linear, rel=1e-5)


@given(dark=slopes, white=slopes)
def test_it_rises_from_black_to_white(dark: float, white: float):
    values = apply_curve(np.linspace(0, 1, 200, dtype=np.float32), dark, white)
    assert values[0] == 0
    assert values[-1] == pytest.approx(1)
    assert (np.diff(values) >= 0).all()
    assert (np.diff(values[2:]) > 0).all()


def test_it_can_follow_the_sigmoid_of_camera_b():
    light = np.linspace(0.02, 0.98, 60, dtype=np.float32)
    decoded = srgb_decode(sigmoid_encode(light, 0.9, 0.6))
    fits = [
        np.abs(np.log(apply_curve(decoded, dark, white) / light)).mean()
        for dark in np.arange(0.5, 1.2, 0.05)
        for white in np.arange(0.8, 1.8, 0.05)
    ]
    assert min(fits) < 0.04

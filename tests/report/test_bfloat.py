"""The coding of radiance in the page: small, and right to 1 in 256 at any brightness."""

import base64

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from panokit.errors import UsageError
from panokit.report.bfloat import decode_radiance, encode_radiance

SIZES = st.tuples(st.integers(1, 7), st.integers(1, 9), st.just(3))


@given(npst.arrays(np.float32, SIZES, elements=st.floats(0, 2.0**120, width=32)))
def test_every_value_comes_back_to_one_in_256(radiance):
    height, width, _ = radiance.shape
    back = decode_radiance(encode_radiance(radiance), width, height)
    # Below the smallest normal float there are fewer bits.
    assert np.all(np.abs(back - radiance) <= np.maximum(radiance / 256, 1e-38))


def test_suns_above_the_range_of_half_floats_survive():
    radiance = np.array([[[65504, 1e6, 3e9], [0, 1e-20, 1]]], np.float32)
    back = decode_radiance(encode_radiance(radiance), 2, 1)
    np.testing.assert_allclose(back, radiance, rtol=1 / 256)
    assert back[0, 1, 0] == 0
    assert back[0, 1, 2] == 1


def test_a_second_round_changes_nothing():
    radiance = np.random.default_rng(0).exponential(size=(16, 32, 3)).astype(np.float32)
    once = decode_radiance(encode_radiance(radiance), 32, 16)
    np.testing.assert_array_equal(decode_radiance(encode_radiance(once), 32, 16), once)


def test_the_largest_float_does_not_become_infinite():
    radiance = np.full((1, 2, 3), np.finfo(np.float32).max, np.float32)
    assert np.isfinite(decode_radiance(encode_radiance(radiance), 2, 1)).all()


def test_smooth_light_costs_little():
    across = np.linspace(0.1, 3, 256, dtype=np.float32)
    radiance = np.tile(across[None, :, None], (128, 1, 3)) * np.float32([0.7, 1, 1.2])
    text = encode_radiance(radiance)
    assert len(base64.b64decode(text)) < 0.1 * radiance.nbytes


@pytest.mark.parametrize(
    "wrong",
    [
        np.zeros((4, 8), np.float32),
        np.zeros((4, 8, 4), np.float32),
        np.zeros((0, 8, 3), np.float32),
        np.full((4, 8, 3), np.nan, np.float32),
        np.full((4, 8, 3), -1, np.float32),
    ],
)
def test_what_is_no_radiance_is_refused(wrong):
    with pytest.raises(UsageError):
        encode_radiance(wrong)

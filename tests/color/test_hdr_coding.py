"""Radiance as numbers for a network: exact both ways, on a fixed scale."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.color.hdr_coding import ColorCode, HdrCoding
from panokit.errors import UsageError


@given(st.lists(st.floats(0, 5e4), min_size=3, max_size=3))
@pytest.mark.parametrize("color", [ColorCode.RGB, ColorCode.LAB])
def test_there_and_back_keeps_radiance(color, values):
    coding = HdrCoding(brightest=1e4, color=color)
    radiance = np.array(values)
    np.testing.assert_allclose(
        coding.decode(coding.encode(radiance)), radiance, rtol=1e-5, atol=1e-4
    )


def test_the_brightest_gray_is_at_the_end_of_the_scale():
    np.testing.assert_allclose(HdrCoding().encode(np.full(3, 1e4)), [1, 0, 0], atol=1e-6)
    np.testing.assert_allclose(HdrCoding().encode(np.zeros(3)), [-1, 0, 0], atol=1e-6)
    rgb = HdrCoding(color=ColorCode.RGB)
    np.testing.assert_allclose(rgb.encode(np.full(3, 1e4)), 1, atol=1e-6)


def test_what_is_brighter_than_the_scale_is_kept_and_counted():
    coding = HdrCoding(brightest=100)
    radiance = np.array([[50.0, 100.0, 400.0]])
    assert coding.beyond(radiance) == 1
    np.testing.assert_allclose(coding.decode(coding.encode(radiance)), radiance, rtol=1e-4)


def test_the_compatible_code_clips_as_it_did():
    coding = HdrCoding(brightest=100, color=ColorCode.PIX2PIX)
    assert coding.decode(coding.encode(np.full(3, 400.0))).max() <= 100.01


def test_a_coding_survives_its_record():
    coding = HdrCoding(brightest=321.0, color=ColorCode.RGB)
    assert HdrCoding.from_json(coding.to_json()) == coding


@pytest.mark.parametrize("brightest", [0, -1, np.inf, np.nan])
def test_a_scale_is_positive_and_finite(brightest):
    with pytest.raises(UsageError, match="positive"):
        HdrCoding(brightest=brightest)

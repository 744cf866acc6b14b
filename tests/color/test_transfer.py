import colour
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.color import (
    bracket,
    luminance,
    srgb_decode,
    srgb_decode_u8,
    srgb_encode,
    srgb_encode_u8,
    tonemap,
    weighted_percentile,
)
from panokit.errors import UsageError


def test_the_curve_is_that_of_the_standard():
    values = np.linspace(0, 1, 101)
    np.testing.assert_allclose(
        srgb_encode(values), colour.models.eotf_inverse_sRGB(values), atol=1e-6
    )
    np.testing.assert_allclose(srgb_decode(values), colour.models.eotf_sRGB(values), atol=1e-6)


@given(st.floats(0, 1, width=32))
def test_encode_and_decode_are_inverse(value):
    assert float(srgb_decode(srgb_encode(np.float32(value)))) == pytest.approx(value, abs=1e-6)


def test_every_8_bit_value_survives():
    codes = np.arange(256, dtype=np.uint8)
    np.testing.assert_array_equal(srgb_encode_u8(srgb_decode_u8(codes)), codes)
    assert srgb_decode_u8(codes)[255] == 1.0


def test_wrong_domains_are_refused():
    with pytest.raises(UsageError, match="255"):
        srgb_decode(np.array([200.0]))
    with pytest.raises(UsageError, match="float32"):
        srgb_decode_u8(np.zeros(3, np.float32))


def test_luminance_of_white_is_one_and_keeps_the_dtype():
    assert luminance(np.ones((2, 3), np.float32)).dtype == np.float32
    assert float(luminance(np.ones(3))) == pytest.approx(1.0)


def test_percentiles_over_the_sphere_count_solid_angle():
    values = np.array([1.0, 2.0, 3.0])
    assert weighted_percentile(values, np.array([1.0, 1.0, 1.0]), 50) == 2.0
    assert weighted_percentile(values, np.array([10.0, 1.0, 1.0]), 50) == 1.0


def test_brackets_show_what_is_brighter_than_white():
    radiance = np.full((4, 8, 3), 4.0, np.float32)
    plain, darker = bracket(radiance, (0, -4))
    assert plain.min() == 255
    assert darker.max() < 255


def test_tonemapping_orders_luminance_and_survives_a_sun():
    radiance = np.full((8, 16, 3), 0.2, np.float32)
    radiance[0, 0] = 1e6
    radiance[4:] = 0.4
    picture = tonemap(radiance)
    assert picture[0, 0].min() > picture[6, 3].max() > picture[2, 3].max() > 30
    assert tonemap(np.zeros((8, 16, 3), np.float32)).max() == 0

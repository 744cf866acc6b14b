import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.color import srgb_encode
from panokit.color.response import SRGB, TONED_BANK, Response, decode, encode
from panokit.errors import UsageError

RAMP = np.linspace(0, 1, 400, dtype=np.float32)

CURVES = [
    SRGB,
    Response(family="gamma", numbers=(2.2,)),
    Response(family="sigmoid", numbers=(0.9, 0.6)),
    *TONED_BANK,
]


@pytest.mark.parametrize("response", CURVES, ids=str)
def test_every_curve_rises_from_black_to_white(response):
    encoded = encode(RAMP, response)
    assert encoded.dtype == np.float32
    assert encoded[0] == pytest.approx(0, abs=1e-6)
    assert encoded[-1] == pytest.approx(1, abs=1e-6)
    assert (np.diff(encoded) > 0).all()


@pytest.mark.parametrize("response", CURVES, ids=str)
def test_decode_undoes_encode(response):
    assert decode(encode(RAMP, response), response) == pytest.approx(RAMP, abs=2e-3)


@given(g=st.floats(1, 3), contrast=st.floats(-1.9, 0.9), shoulder=st.floats(0, 5))
def test_toned_curves_of_any_allowed_numbers_rise(g, contrast, shoulder):
    response = Response(family="toned", numbers=(g, contrast, shoulder))
    assert (np.diff(encode(RAMP, response)) >= 0).all()


def test_the_bank_has_curves_that_differ_as_cameras_do():
    middle = [float(encode(np.float32(0.18), response)) for response in TONED_BANK]
    assert max(middle) - min(middle) > 0.15
    assert len(set(TONED_BANK)) == len(TONED_BANK) >= 8


def test_contrast_steepens_the_middle_and_the_shoulder_lifts_it():
    plain, lively, pressed = (
        encode(RAMP, Response(family="toned", numbers=(2.2, *numbers)))
        for numbers in ((0, 0), (0.5, 0), (0, 1.5))
    )
    # Under a contrast curve dark grows darker and light lighter.
    assert (lively < plain)[(plain > 0.1) & (plain < 0.4)].all()
    assert (lively > plain)[(plain > 0.6) & (plain < 0.9)].all()
    assert (pressed > plain)[1:-1].all()


def test_srgb_is_srgb():
    assert np.array_equal(encode(RAMP, SRGB), srgb_encode(RAMP))


@pytest.mark.parametrize(
    ("family", "numbers"),
    [
        ("srgb", (1.0,)),
        ("gamma", ()),
        ("gamma", (0.0,)),
        ("sigmoid", (0.9, -1.0)),
        ("toned", (2.2, 1.5, 0.0)),
        ("toned", (2.2, 0.0, float("nan"))),
        ("filmic", ()),
    ],
)
def test_numbers_that_make_no_curve_are_refused(family, numbers):
    with pytest.raises(UsageError, match="families"):
        Response(family=family, numbers=numbers)

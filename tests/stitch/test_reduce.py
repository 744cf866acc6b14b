import numpy as np
import pytest

from panokit.color import srgb_decode_u8
from panokit.sphere import energy
from panokit.stitch.reduce import Reducer


def reduced(picture, width_px, rows_at_once, valid=None):
    reducer = Reducer(picture.shape[1], width_px)
    for top in range(0, len(picture), rows_at_once):
        rows = slice(top, top + rows_at_once)
        reducer.add(top, picture[rows], None if valid is None else valid[rows])
    return reducer.result()


@pytest.mark.parametrize("width_px", [208, 128, 100])
def test_the_light_of_the_whole_picture_stays(scene, width_px):
    picture = scene(416)
    small, valid = reduced(picture, width_px, 64)
    before, after = energy(srgb_decode_u8(picture)), energy(srgb_decode_u8(small))
    assert valid is None
    # What remains is the rounding to 8 bits.
    assert np.allclose(after, before, rtol=2e-3)


@pytest.mark.parametrize("rows_at_once", [1, 7, 64, 208])
def test_the_strips_leave_no_trace(scene, rows_at_once):
    picture = scene(416)
    whole, _ = reduced(picture, 100, 1000)
    strips, _ = reduced(picture, 100, rows_at_once)
    assert np.abs(whole.astype(int) - strips).max() <= 1


def test_a_lamp_is_averaged_as_light_and_not_as_code_values():
    picture = np.zeros((128, 256, 3), np.uint8)
    picture[64, 128] = 255
    small, _ = reduced(picture, 64, 32)
    # 1/16 of white light is the code value 71; the mean of the code values would be 16.
    assert small.max() == pytest.approx(71, abs=1)


def test_half_covered_pixels_show_only_what_is_valid():
    picture = np.full((128, 256, 3), 180, np.uint8)
    valid = np.ones((128, 256), bool)
    valid[30:61, 50:91] = False
    picture[~valid] = 0
    small, still_valid = reduced(picture, 64, 32, valid)
    assert np.all(small[still_valid] == 180)
    assert not still_valid[8:15, 13:22].any()
    assert still_valid.sum() >= 64 * 32 - 9 * 12

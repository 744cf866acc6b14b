import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.inpaint.membrane import membrane


@settings(max_examples=30, deadline=None)
@given(
    height=st.integers(1, 40),
    width=st.integers(1, 40),
    seed=st.integers(0, 99),
    wraps=st.booleans(),
)
def test_known_pixels_stay_and_the_rest_lies_between_them(height, width, seed, wraps):
    rng = np.random.default_rng(seed)
    picture = rng.uniform(10, 90, (height, width, 3)).astype(np.float32)
    known = rng.uniform(size=(height, width)) < 0.4
    known.flat[0] = True
    filled = membrane(picture, known, wraps=wraps)
    assert np.array_equal(filled[known], picture[known])
    for channel in range(3):
        low, high = picture[known][:, channel].min(), picture[known][:, channel].max()
        assert filled[..., channel].min() >= low - 1e-3
        assert filled[..., channel].max() <= high + 1e-3


def test_a_hole_in_a_ramp_is_filled_with_the_ramp():
    ramp = np.broadcast_to(np.linspace(0, 100, 128, dtype=np.float32)[None, :, None], (64, 128, 3))
    known = np.ones((64, 128), bool)
    known[24:40, 50:70] = False
    filled = membrane(np.where(known[..., None], ramp, 0).astype(np.float32), known)
    assert np.abs(filled - ramp).max() < 6


def test_a_hole_at_the_seam_is_filled_from_both_sides_where_the_picture_wraps():
    picture = np.zeros((32, 64, 1), np.float32)
    picture[:, :32] = 80
    known = np.ones((32, 64), bool)
    known[8:24, :4] = False
    wrapped = membrane(picture, known, wraps=True)
    flat = membrane(picture, known, wraps=False)
    assert wrapped[16, 0, 0] < flat[16, 0, 0] - 15


def test_nothing_known_gives_nothing():
    empty = membrane(np.full((8, 8, 3), 7, np.float32), np.zeros((8, 8), bool))
    assert np.all(empty == 0)


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (3, 5)])
def test_small_and_odd_pictures_work(shape):
    known = np.zeros(shape, bool)
    known.flat[-1] = True
    filled = membrane(np.full((*shape, 2), 5, np.float32), known)
    assert np.allclose(filled, 5)

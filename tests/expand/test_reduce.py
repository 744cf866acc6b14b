import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.color import srgb_decode_u8
from panokit.expand.reduce import burnt_out, reduce_panorama
from panokit.sphere import energy


def noise(height: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (height, 2 * height, 3), np.uint8)


def test_two_channels_make_a_pixel_burnt_out_and_one_does_not():
    colors = np.array([[255, 251, 90], [255, 240, 90], [40, 120, 255], [250, 250, 0]], np.uint8)
    assert burnt_out(colors).tolist() == [True, False, False, True]


def test_at_its_own_size_a_picture_is_only_split():
    pixels = noise(32)
    reduced = reduce_panorama(pixels, 64)
    assert np.allclose(reduced.linear, srgb_decode_u8(pixels), atol=1e-6)
    assert not (reduced.clear * reduced.burnt).any()
    assert np.array_equal(reduced.share > 0, burnt_out(pixels))


@settings(deadline=None, max_examples=20)
@given(height=st.integers(20, 90), target=st.integers(8, 20), seed=st.integers(0, 9))
def test_reducing_keeps_the_energy_at_any_ratio(height: int, target: int, seed: int):
    pixels = noise(height, seed)
    reduced = reduce_panorama(pixels, 2 * target)
    assert energy(reduced.linear) == pytest.approx(energy(srgb_decode_u8(pixels)), rel=1e-4)


def test_a_lamp_thinner_than_a_target_pixel_keeps_its_share():
    pixels = np.full((256, 512, 3), 60, np.uint8)
    pixels[100, 200] = 255  # a fourth of a target pixel's side, a sixteenth of its area
    reduced = reduce_panorama(pixels, 128)
    assert reduced.share[25, 50] == pytest.approx(1 / 16, rel=0.02)
    assert reduced.burnt[25, 50] == pytest.approx([1 / 16] * 3, rel=0.02)
    assert np.count_nonzero(reduced.share) == 1


def test_strips_do_not_show(monkeypatch):
    pixels = noise(64)
    whole = reduce_panorama(pixels, 40)
    monkeypatch.setattr("panokit.expand.reduce._STRIP_PIXELS", 5 * 128)
    in_strips = reduce_panorama(pixels, 40)
    assert np.allclose(whole.clear, in_strips.clear, atol=1e-6)
    assert np.allclose(whole.share, in_strips.share, atol=1e-6)


def test_the_burnt_share_of_the_upper_half_is_a_half():
    pixels = np.zeros((32, 64, 3), np.uint8)
    pixels[:16] = 255
    assert reduce_panorama(pixels, 32).burnt_share == pytest.approx(0.5, abs=1e-6)

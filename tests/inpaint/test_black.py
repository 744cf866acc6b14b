import numpy as np
import pytest

from panokit.inpaint.black import find_black

WIDTH = 1024


def box(top, bottom, left, right):
    mask = np.zeros((WIDTH // 2, WIDTH), bool)
    mask[top:bottom, left:right] = True
    return mask


@pytest.mark.parametrize(
    "missing",
    [
        box(128, 192, 320, 384),
        box(128, 256, 320, 384) | box(192, 256, 384, 512),
        box(448, 512, 0, WIDTH),
        box(0, 512, WIDTH - 64, WIDTH),
    ],
    ids=["tile", "tiles", "bottom", "right"],
)
def test_black_tiles_and_bars_are_found(textured, missing):
    pixels = np.maximum(textured(WIDTH), 20)
    pixels[missing] = 1
    found, confidence = find_black(pixels)
    assert found[missing].all()
    assert (found & ~missing).sum() < 0.2 * missing.sum()
    assert confidence > 0.9


def test_what_the_panorama_says_is_missing_is_not_found_again(textured):
    missing = box(128, 192, 320, 384)
    pixels = textured(WIDTH)
    pixels[missing] = 0
    found, confidence = find_black(pixels, ~missing)
    assert (found.any(), confidence) == (False, 0)


def test_a_round_black_thing_is_no_tile(textured, cap_around):
    pixels = np.maximum(textured(WIDTH), 20)
    pixels[cap_around(WIDTH, (0.3, 0.1, -0.9), 12)] = 0
    assert not find_black(pixels)[0].any()


def test_a_night_that_fades_into_black_is_no_hole():
    level = np.clip(np.linspace(60, -40, WIDTH // 2), 0, 255)[:, None, None]
    pixels = np.broadcast_to(level, (WIDTH // 2, WIDTH, 3)).astype(np.uint8)
    assert (pixels == 0).mean() > 0.2
    assert not find_black(pixels)[0].any()


def test_a_clean_picture_has_none(textured):
    assert not find_black(textured(WIDTH))[0].any()

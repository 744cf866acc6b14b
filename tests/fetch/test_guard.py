"""Black in place of a picture, told from night, caps and half-size bodies."""

import cv2
import numpy as np
import pytest

from panokit.capture import TileGrid
from panokit.errors import ImageError
from panokit.fetch import guard
from panokit.io.images import encode_jpeg

GRID = TileGrid(width_px=832, height_px=416, tile_width_px=512, tile_height_px=512)
WIDE = TileGrid(width_px=2048, height_px=1024, tile_width_px=512, tile_height_px=512)


def tile(level=120, width_px=512, height_px=512, noise=6.0):
    rng = np.random.default_rng(1)
    pixels = rng.normal(level, noise, (height_px, width_px, 3))
    return np.clip(pixels, 0, 255).astype(np.uint8)


def seen(pixels):
    return guard.glance(encode_jpeg(pixels, quality=85))


BRIGHT, NIGHT, LOST = seen(tile()), seen(tile(6, noise=3)), seen(np.zeros((512, 512, 3), np.uint8))


def tiles(fill, **others):
    return {cell: others.get(f"at_{cell[0]}_{cell[1]}", fill) for cell in WIDE.cells()}


def test_a_glance_is_an_eighth():
    assert seen(tile()).shape == (64, 64)
    with pytest.raises(ImageError, match="cannot be decoded"):
        guard.glance(b"\xff\xd8no picture")


@pytest.mark.parametrize("body", ["padded", "cropped", "half"])
def test_bodies_of_all_kinds_fill_their_cells(body):
    full = {"padded": (512, 512), "cropped": (320, 416), "half": (512, 512)}[body]
    pixels = tile(width_px=full[0], height_px=full[1])
    if body != "cropped":
        pixels[416:], pixels[:, 320:] = 0, 0
    if body == "half":
        pixels = np.ascontiguousarray(pixels[::2, ::2])
    left = tile()
    left[416:] = 0
    frame = guard.lay_out({(0, 0): seen(left), (1, 0): seen(pixels)}, GRID)
    assert frame.shape == (52, 104)
    assert frame.min() > 80, "padding got into the frame"
    assert frame.max() < 160, "a part of the frame is empty"


def test_one_black_tile_among_bright_ones_is_lost():
    assert guard.lost_cells(tiles(BRIGHT), WIDE) == frozenset()
    assert guard.lost_cells(tiles(BRIGHT, at_3_1=LOST), WIDE) == {(3, 1)}
    both = tiles(BRIGHT, at_0_0=LOST, at_0_1=LOST)
    assert guard.lost_cells(both, WIDE) == {(0, 0), (0, 1)}


def test_black_beside_night_is_night():
    assert guard.lost_cells(tiles(NIGHT, at_2_0=LOST), WIDE) == frozenset()


def test_a_lost_tile_is_told_from_a_night_sky_elsewhere():
    mixed = {cell: NIGHT if cell[0] < 2 else BRIGHT for cell in WIDE.cells()}
    mixed[0, 0] = mixed[3, 1] = LOST
    # The first tile's neighbor over the seam is bright, but most of what is around it is not.
    assert guard.lost_cells(mixed, WIDE) == {(3, 1)}


def test_nothing_but_black_is_lost():
    assert len(guard.lost_cells(tiles(LOST), WIDE)) == len(WIDE.cells())


def frame(**bars):
    picture = np.full((128, 256), 90, np.uint8)
    for where in bars.values():
        picture[where] = 0
    return picture


@pytest.mark.parametrize(
    ("bars", "reason"),
    [
        ({"right": np.s_[:, 208:]}, "black-columns"),
        ({"one": np.s_[:, 255:]}, "black-columns"),
        ({"right": np.s_[:, 208:], "foot": np.s_[104:]}, "black-columns"),
        ({"foot": np.s_[80:]}, "black-rows"),
        ({"middle": np.s_[60:62]}, "black-rows"),
        ({"most": np.s_[:, 100:]}, "black-frame"),
    ],
)
def test_black_bars_are_refused(bars, reason):
    with pytest.raises(ImageError) as caught:
        guard.check_frame(frame(**bars), "a picture")
    assert caught.value.reason == reason


def test_caps_that_the_camera_does_not_see_and_nights_are_fine():
    guard.check_frame(frame(zenith=np.s_[:10], nadir=np.s_[110:]), "a picture")
    guard.check_frame(np.full((128, 256), 2, np.uint8), "a night")
    dark = cv2.resize(NIGHT, (256, 128))
    guard.check_frame(dark, "a night")


def test_only_tiles_that_may_be_black_are_decoded():
    rich, plain = b"x" * 30_000, b"x" * 3_000
    assert guard.is_too_rich_for_black(rich, WIDE, (1, 0))
    assert not guard.is_too_rich_for_black(plain, WIDE, (1, 0))
    assert not guard.is_too_rich_for_black(rich, WIDE, (3, 0)), "the last column may have a bar"
    assert not guard.is_too_rich_for_black(rich, WIDE, (1, 1)), "the last row too"
    for level in (0, 1):
        body = encode_jpeg(np.full((512, 512, 3), level, np.uint8), quality=95)
        assert not guard.is_too_rich_for_black(body, WIDE, (0, 0))

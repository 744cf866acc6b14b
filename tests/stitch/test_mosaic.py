import cv2
import numpy as np
import pytest

from panokit.errors import ImageError
from panokit.stitch.mosaic import mosaic


def encode(pixels, suffix=".jpg"):
    return cv2.imencode(suffix, pixels[..., ::-1])[1].tobytes()


# Of Google's sizes, an eighth: whole tiles, cut columns, and both cut.
@pytest.mark.parametrize("width_px", [512, 832, 416, 672])
def test_every_pixel_is_in_its_place_whatever_the_size(tile_store, scene, width_px):
    picture = scene(width_px)
    stored = tile_store(picture, suffix=".png")
    made = mosaic(stored, stored.grid, None)
    assert np.array_equal(made.pixels, picture)
    assert made.valid is None
    assert made.tiles == stored.grid.columns * stored.grid.rows


def test_jpeg_tiles_come_within_their_compression(tile_store, scene):
    picture = scene(832)
    stored = tile_store(picture)
    made = mosaic(stored, stored.grid, None)
    assert np.abs(made.pixels.astype(int) - picture).mean() < 3


@pytest.mark.parametrize("width_px", [None, 208])
def test_missing_tiles_are_not_valid(tile_store, scene, width_px):
    picture = scene(416)
    stored = tile_store(picture, missing=[(1, 0), (6, 3)])
    made = mosaic(stored, stored.grid, width_px)
    scale = made.pixels.shape[1] / 416
    expected = np.ones(made.pixels.shape[:2], bool)
    expected[: int(64 * scale), int(64 * scale) : int(128 * scale)] = False
    expected[int(192 * scale) :, int(384 * scale) :] = False
    assert np.array_equal(made.valid, expected)
    assert made.missing == [(1, 0), (6, 3)]


def test_a_missing_tile_does_not_darken_its_neighbors(tile_store, scene):
    picture = np.full((208, 416, 3), 200, np.uint8)
    stored = tile_store(picture, missing=[(2, 1)], suffix=".png")
    made = mosaic(stored, stored.grid, 96)  # a width that shares no edge with the tiles
    assert np.all(made.pixels[made.valid] == 200)


def test_a_black_tile_in_a_bright_picture_is_missing(tile_store, scene):
    black = {(2, 1): lambda tile: encode(np.zeros_like(tile))}
    stored = tile_store(scene(416), replace=black)
    made = mosaic(stored, stored.grid, None)
    assert made.black == [(2, 1)]
    assert not made.valid[64:128, 128:192].any()
    assert made.valid.sum() == 208 * 416 - 64 * 64


def test_black_tiles_in_a_row_are_missing_together(tile_store, scene):
    black = {(column, 3): lambda tile: encode(np.zeros_like(tile)) for column in range(7)}
    stored = tile_store(scene(416), replace=black)
    made = mosaic(stored, stored.grid, None)
    assert len(made.black) == 7


def test_a_black_tile_of_a_night_sky_is_kept(tile_store, scene):
    # Lit below, and darker and darker toward the zenith.
    height = np.linspace(0, 1, 208, dtype=np.float32)[:, None, None]
    picture = (scene(416) * np.clip(height - 0.35, 0, 1)).astype(np.uint8)
    assert picture[:64].max() == 0
    stored = tile_store(picture)
    made = mosaic(stored, stored.grid, None)
    assert made.black == []
    assert made.valid is None


def test_half_size_tiles_are_resized_and_recorded(tile_store, scene):
    half = {(1, 1): lambda tile: encode(cv2.resize(tile, (32, 32), interpolation=cv2.INTER_AREA))}
    picture = scene(416)
    stored = tile_store(picture, replace=half)
    made = mosaic(stored, stored.grid, None)
    assert made.resized == [(1, 1)]
    assert made.valid is None
    difference = np.abs(made.pixels.astype(int) - picture)
    assert difference[64:128, 64:128].mean() < 8


def test_a_truncated_tile_is_an_error_unless_the_grid_says_missing(tile_store, scene):
    cut = {(3, 2): lambda tile: encode(tile)[:-200]}
    stored = tile_store(scene(416), replace=cut)
    with pytest.raises(ImageError, match="3_2") as raised:
        mosaic(stored, stored.grid, None)
    assert raised.value.reason == "bad-tile"
    forgiven = tile_store(scene(416), replace=cut, missing=[(3, 2)])
    assert not mosaic(forgiven, forgiven.grid, None).valid[128:192, 192:256].any()


def test_a_tile_that_nobody_speaks_of_is_an_error(tile_store, scene):
    stored = tile_store(scene(416))
    del stored.files["tiles/4_0.jpg"]
    with pytest.raises(ImageError, match="4_0") as raised:
        mosaic(stored, stored.grid, None)
    assert raised.value.reason == "bad-tile"


@pytest.mark.parametrize("width_px", [None, 208])
def test_nothing_but_black_is_an_error(tile_store, width_px):
    stored = tile_store(np.zeros((208, 416, 3), np.uint8))
    with pytest.raises(ImageError) as raised:
        mosaic(stored, stored.grid, width_px)
    assert raised.value.reason == "no-tiles"

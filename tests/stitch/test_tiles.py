import cv2
import numpy as np
import pytest

from panokit.capture import TileGrid
from panokit.errors import ImageError
from panokit.stitch.tiles import cell_from_name, cell_of, decode_tile, fit_tile

GRID = TileGrid(width_px=208, height_px=104, tile_width_px=64, tile_height_px=64)


def png(pixels):
    return cv2.imencode(".png", pixels[..., ::-1])[1].tobytes()


def gradient(width, height):
    ramp = np.linspace(50, 200, width, dtype=np.float32)[None, :, None]
    return np.broadcast_to(ramp, (height, width, 3)).astype(np.uint8)


def test_cells_are_cut_at_the_pictures_edge():
    last = cell_of(GRID, 3, 1)
    assert (last.left, last.top, last.width, last.height) == (192, 64, 16, 40)
    assert sum(cell_of(GRID, *cell).width for cell in GRID.cells() if cell[1] == 0) == 208


@pytest.mark.parametrize(
    ("name", "cell"),
    [
        ("tiles/3_1.jpg", (3, 1)),
        ("tiles/12_0.png", (12, 0)),
        ("image.jpg", None),
        ("tiles/3.jpg", None),
    ],
)
def test_the_name_says_the_cell(name, cell):
    assert cell_from_name(name) == cell


def test_decodes_to_rgb():
    pixels = np.zeros((8, 8, 3), np.uint8)
    pixels[..., 0] = 200
    assert np.array_equal(decode_tile(png(pixels), "0_0.png"), pixels)


@pytest.mark.parametrize("suffix", [".jpg", ".png"])
def test_a_cut_off_tile_is_named(suffix):
    pixels = np.random.default_rng(0).integers(0, 255, (64, 64, 3), np.uint8)
    whole = cv2.imencode(suffix, pixels)[1].tobytes()
    with pytest.raises(ImageError, match="5_2") as raised:
        decode_tile(whole[: len(whole) // 2], f"tiles/5_2{suffix}")
    assert raised.value.reason == "bad-tile"


@pytest.mark.parametrize("data", [b"", b"<html>Too many requests</html>", b"\xff\xd8\xff\xd9"])
def test_what_is_no_image_is_a_bad_tile(data):
    with pytest.raises(ImageError) as raised:
        decode_tile(data, "tiles/0_0.jpg")
    assert raised.value.reason == "bad-tile"


def test_padded_and_cropped_bodies_give_the_same_pixels():
    cell = cell_of(GRID, 3, 1)
    padded = np.zeros((64, 64, 3), np.uint8)
    padded[:40, :16] = gradient(16, 40)
    from_padded, padded_resized = fit_tile(padded, GRID, cell, "3_1")
    from_cropped, cropped_resized = fit_tile(gradient(16, 40), GRID, cell, "3_1")
    assert np.array_equal(from_padded, from_cropped)
    assert not padded_resized
    assert not cropped_resized


@pytest.mark.parametrize(
    ("column", "row", "body"),
    [(0, 0, (32, 32)), (3, 1, (32, 32)), (3, 1, (8, 20)), (0, 1, (128, 128))],
)
def test_another_resolution_is_resized_and_said_so(column, row, body):
    cell = cell_of(GRID, column, row)
    pixels, resized = fit_tile(gradient(*body), GRID, cell, "tile")
    assert resized
    assert pixels.shape == (cell.height, cell.width, 3)


def test_a_half_size_tile_keeps_its_place():
    full = gradient(64, 64)
    half = cv2.resize(full, (32, 32), interpolation=cv2.INTER_AREA)
    pixels, _ = fit_tile(half, GRID, cell_of(GRID, 0, 0), "0_0")
    assert np.abs(pixels.astype(int) - full).max() <= 2


def test_a_body_of_another_shape_is_a_bad_tile():
    with pytest.raises(ImageError, match="64x30") as raised:
        fit_tile(gradient(64, 30), GRID, cell_of(GRID, 0, 0), "0_0")
    assert raised.value.reason == "bad-tile"

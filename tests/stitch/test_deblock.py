import numpy as np
import pytest

from panokit.capture import TileGrid
from panokit.stitch.deblock import deblock
from panokit.stitch.mosaic import mosaic

GRID = TileGrid(width_px=128, height_px=64, tile_width_px=32, tile_height_px=32)


def test_small_steps_between_tiles_are_halved():
    pixels = np.full((64, 128, 3), 100, np.uint8)
    pixels[:, 32:64] = 104
    deblock(pixels, GRID)
    assert (pixels[5, 31, 0], pixels[5, 32, 0]) == (101, 103)
    assert (pixels[5, 63, 0], pixels[5, 64, 0]) == (103, 101)
    assert (pixels[:, :31] == 100).all()
    assert (pixels[:, 33:63] == 104).all()


def test_the_step_across_the_wrap_is_one_too():
    pixels = np.full((64, 128, 3), 100, np.uint8)
    pixels[:, 96:] = 104
    deblock(pixels, GRID)
    assert (pixels[5, -1, 0], pixels[5, 0, 0]) == (103, 101)


def test_edges_of_the_scene_and_slopes_stay():
    edge = np.full((64, 128, 3), 60, np.uint8)
    edge[:, 32:] = 160
    edge[:, 96:] = 60
    slope = np.empty((64, 128, 3), np.uint8)
    slope[:] = np.minimum(np.arange(128), 127 - np.arange(128))[None, :, None] + 50
    for picture in (edge, slope):
        after = picture.copy()
        deblock(after, GRID)
        assert np.array_equal(after[:, 1:-1], picture[:, 1:-1])


@pytest.mark.parametrize("soften", [False, True])
def test_it_is_a_choice_of_mosaics(tile_store, scene, soften):
    stored = tile_store(scene(128), 32, suffix=".png", replace={})
    plain = mosaic(stored, stored.grid, None).pixels
    made = mosaic(stored, stored.grid, None, soften=soften).pixels
    changed = (made != plain).any(axis=(0, 2))
    inner = np.isin(np.arange(128) % 32, (0, 31))
    assert changed[inner].any() == soften
    rows = (made != plain).any(axis=(1, 2))
    assert not (changed & ~inner & ~rows.any()).any()

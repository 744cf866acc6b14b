import cv2
import numpy as np
import pytest

from panokit.inpaint import InpaintSettings, inpaint
from panokit.inpaint.watermark import find_watermark, watermark_on_tiles


def scenes(count, size=128, seed=0):
    rng = np.random.default_rng(seed)
    noise = [cv2.GaussianBlur(rng.normal(0, 1, (size, size)), (0, 0), 2) for _ in range(count)]
    return [np.clip(120 + 160 * each[..., None] + np.zeros(3), 0, 255) for each in noise]


def mark(size=128):
    drawn = np.zeros((size, size), np.uint8)
    cv2.putText(drawn, "(c) maps", (10, 100), cv2.FONT_HERSHEY_SIMPLEX, 0.6, 255, 2)
    return drawn > 0


def test_a_faint_mark_is_found_where_it_is():
    tiles = np.stack([np.where(mark()[..., None], s + 25, s) for s in scenes(60)])
    found, confidence = find_watermark(np.clip(tiles, 0, 255).astype(np.uint8))
    assert found[mark()].mean() > 0.9
    near = cv2.dilate(mark().astype(np.uint8), np.ones((25, 25), np.uint8)) > 0
    assert not found[~near].any()
    assert confidence > 0.6


def test_tiles_without_a_mark_have_none():
    found, confidence = find_watermark(np.stack(scenes(60)).astype(np.uint8))
    assert (found.any(), confidence) == (False, 0)


def test_from_a_few_tiles_nothing_can_be_said():
    tiles = np.stack([np.where(mark()[..., None], 255, s) for s in scenes(5)]).astype(np.uint8)
    assert not find_watermark(tiles)[0].any()


@pytest.fixture
def marked():
    tiles = np.array(scenes(32)).reshape(4, 8, 128, 128, 3)
    clean = tiles.swapaxes(1, 2).reshape(512, 1024, 3).astype(np.uint8)
    where = np.tile(mark(), (4, 8))
    return np.where(where[..., None], clean + np.minimum(40, 255 - clean), clean), where


def test_the_mark_of_a_panorama_is_found_on_every_tile(marked):
    pixels, where = marked
    found, confidence = watermark_on_tiles(pixels, 128)
    assert found[where].mean() > 0.9
    assert confidence > 0.8
    assert not watermark_on_tiles(pixels[:, ::-1], 96)[0].any()


def test_the_stage_takes_it_away_when_asked(marked, panorama_of):
    pixels, _ = marked
    untouched = inpaint(panorama_of(pixels), InpaintSettings(nadir_deg=None))
    assert np.array_equal(untouched.pixels, pixels)
    settings = InpaintSettings(nadir_deg=None, watermark_tile_px=128, method="smooth")
    filled = inpaint(panorama_of(pixels), settings)
    (hole,) = filled.provenance.steps[-1].values["holes"]
    assert hole["kind"] == "watermark"
    assert hole["confidence"] > 0.8
    fold = (filled.pixels.astype(float) - cv2.blur(filled.pixels.astype(float), (25, 25))).mean(-1)
    left = np.median(fold.reshape(4, 128, 8, 128).swapaxes(1, 2).reshape(32, 128, 128), axis=0)
    assert np.abs(left[mark()]).mean() < 8

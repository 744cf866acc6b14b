import cv2
import numpy as np
import pytest

from panokit.errors import ImageError, RecordError, SettingsError
from panokit.frames import Frame
from panokit.stitch import StitchSettings, stitch


def png(pixels):
    return cv2.imencode(".png", pixels[..., ::-1])[1].tobytes()


def test_tiles_become_a_panorama_with_north_at_the_center(tile_store, scene):
    picture = scene(416)
    panorama = stitch(tile_store(picture, suffix=".png", heading_deg=90.0))
    assert panorama.frame is Frame.WORLD
    assert np.array_equal(panorama.pixels, np.roll(picture, 104, axis=1))
    assert panorama.valid is None


def test_the_record_says_what_was_found_and_assumed(tile_store, scene):
    stored = tile_store(scene(416), missing=[(0, 0)], pitch_deg=3.0)
    (step,) = stitch(stored, StitchSettings(width_px=208)).provenance.steps
    assert step.stage == "stitch"
    assert step.values["native_size_px"] == [416, 208]
    assert step.values["tiles"] == 28
    assert step.values["tiles_missing"] == [[0, 0]]
    assert step.values["tiles_resized"] == []
    assert step.values["known"] == ["pitch"]
    assert step.values["assumed"] == ["roll"]
    assert step.values["frame"] == "level"


def test_it_can_be_left_as_the_camera_stood(tile_store, scene):
    picture = scene(416)
    stored = tile_store(picture, suffix=".png", heading_deg=90.0, pitch_deg=10.0)
    panorama = stitch(stored, StitchSettings(level=False))
    assert panorama.frame is Frame.CAMERA
    assert np.array_equal(panorama.pixels, picture)


def test_a_missing_tile_moves_with_the_heading(tile_store, scene):
    panorama = stitch(tile_store(scene(512), missing=[(0, 1)], heading_deg=90.0))
    expected = np.ones((256, 512), bool)
    expected[64:128, 128:192] = False
    assert np.array_equal(panorama.valid, expected)


def test_the_width_is_never_raised(tile_store, scene):
    assert stitch(tile_store(scene(416)), StitchSettings(width_px=1024)).width_px == 416


def test_one_picture_is_reduced_and_leveled_too(tile_store, scene):
    picture = scene(512)
    stored = tile_store.store({"image.png": png(picture)}, heading_deg=180.0)
    native = stitch(stored, StitchSettings(width_px=None))
    assert np.array_equal(native.pixels, np.roll(picture, 256, axis=1))
    small = stitch(stored, StitchSettings(width_px=256))
    assert small.width_px == 256
    assert small.provenance.steps[0].values["native_size_px"] == [512, 256]


@pytest.mark.parametrize("tiled", [True, False])
def test_what_is_not_two_to_one_is_refused(tile_store, tiled):
    picture = np.full((128, 384, 3), 90, np.uint8)
    stored = tile_store(picture) if tiled else tile_store.store({"image.png": png(picture)})
    with pytest.raises(ImageError, match="384x128") as raised:
        stitch(stored)
    assert raised.value.reason == "not-equirectangular"


def test_a_capture_without_any_picture_is_refused(tile_store):
    with pytest.raises(ImageError) as raised:
        stitch(tile_store.store({}))
    assert raised.value.reason == "no-picture"


def test_a_file_that_changed_since_it_was_fetched_is_refused(tile_store, scene):
    stored = tile_store(scene(416))
    (stored.folder / "tiles/2_2.jpg").write_bytes(b"something else")
    with pytest.raises(RecordError, match="2_2"):
        stitch(stored)


def test_the_same_capture_gives_the_same_record_and_pixels(tile_store, scene):
    stored = tile_store(scene(416), heading_deg=33.0, pitch_deg=2.0, roll_deg=-1.0)
    first, second = stitch(stored), stitch(stored)
    assert np.array_equal(first.pixels, second.pixels)
    assert first.provenance.digest == second.provenance.digest


def test_an_odd_width_is_refused():
    with pytest.raises((SettingsError, ValueError), match="odd"):
        StitchSettings(width_px=1023)


def test_none_can_be_said_in_toml():
    assert StitchSettings(width_px="none").width_px is None

"""Expand without a browser: the stages of the command line on one picture."""

import json

import numpy as np
import pytest

from panokit.app import expanding
from panokit.app.packing import packed
from panokit.errors import ImageError, ItemError
from panokit.expand.settings import ExpandSettings
from panokit.inpaint.settings import InpaintSettings
from panokit.io import encode_jpeg


@pytest.fixture
def street(tmp_path):
    """A sky with a burnt-out sun, a ground with a black cap below the camera."""
    rng = np.random.default_rng(0)
    pixels = np.zeros((256, 512, 3), np.uint8)
    pixels[:128] = (120, 150, 200)
    pixels[128:] = rng.integers(80, 120, (128, 512, 1))
    pixels[40:48, 100:110] = 255
    pixels[240:] = 0
    path = tmp_path / "street.jpg"
    path.write_bytes(encode_jpeg(pixels, quality=95))
    return path


def test_holes_are_filled_and_told(street, tmp_path):
    filled = expanding.fill_holes(street, tmp_path / "out", InpaintSettings(nadir_deg=11))
    assert filled.path != street
    assert filled.size_px == (512, 256)
    assert all(hole["filled"] for hole in filled.holes)
    assert any("A cap below the camera" in said for said in expanding.hole_sentences(filled))
    assert filled.before.startswith(b"\xff\xd8")
    assert filled.before != filled.after


def test_without_settings_a_picture_is_taken_as_it_is(street, tmp_path):
    filled = expanding.fill_holes(street, tmp_path / "out", None)
    assert filled.path == street
    assert not filled.before
    assert expanding.hole_sentences(filled) == ["No holes were found."]


def test_a_map_is_what_the_command_line_writes(street, tmp_path):
    from panokit.cli.main import main

    settings = ExpandSettings(model="area", width_px=128)
    made = expanding.expand_picture(street, tmp_path / "app", settings)
    assert main(["expand", str(street), "--out", str(tmp_path / "cli"), "--model", "area",
                 "--width-px", "128"]) == 0  # fmt: skip
    theirs = tmp_path / "cli" / "street.exr"
    assert made.path.read_bytes() == theirs.read_bytes()
    facts = dict(expanding.expansion_facts(made.values))
    assert facts["Width"] == "128 px"


def test_the_viewer_holds_all_that_is_compared(street, tmp_path):
    maps = [
        expanding.expand_picture(street, tmp_path, ExpandSettings(model=model, width_px=128))
        for model in ("area", "srgb")
    ]
    page = expanding.viewer_page(maps[0], maps[1:], street, "street").decode()
    for label in ("Energy by area", "sRGB curve undone", "Panorama"):
        assert label in page


def test_every_form_is_written(street, tmp_path):
    made = expanding.expand_picture(street, tmp_path, ExpandSettings(model="area", width_px=128))
    for form in expanding.FORMS:
        room = tmp_path / form
        room.mkdir()
        files = expanding.write_forms(made.path, "light", form, room)
        assert all(path.is_file() for path in files)
        content, media_type, name = packed(files, "light", form)
        assert content.is_file()
        assert media_type
        assert name.startswith("light")
    record = json.loads((tmp_path / "record" / "light.json").read_text())
    assert record["provenance"]


def test_what_is_no_panorama_is_told(tmp_path):
    path = tmp_path / "square.jpg"
    path.write_bytes(encode_jpeg(np.full((64, 64, 3), 90, np.uint8)))
    with pytest.raises(ImageError, match="square"):
        expanding.fill_holes(path, tmp_path / "out", InpaintSettings())
    black = tmp_path / "black.jpg"
    black.write_bytes(encode_jpeg(np.zeros((64, 128, 3), np.uint8)))
    with pytest.raises(ItemError, match="black"):
        expanding.expand_picture(black, tmp_path, ExpandSettings(model="area"))


def test_networks_come_before_formulas():
    models = list(expanding.expansion_models())
    assert models[-3:] == list(expanding.ANALYTIC_METHODS)
    assert models[0].startswith("expand-")

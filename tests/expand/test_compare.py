import json

import numpy as np
import pytest

from panokit.cli.main import main
from panokit.color import luminance
from panokit.envmap import Anchor
from panokit.expand import ExpandSettings, expand
from panokit.expand.compare import compare_methods, comparison_picture
from panokit.io import read_environment_map
from panokit.io.images import decode_image, encode_png
from panokit.panorama import Panorama

NAMES = ["ldr", "srgb", "reinhard", "area", "expand-2"]


@pytest.fixture
def maps(lamps, capture):
    panorama = Panorama(pixels=lamps, capture=capture)
    settings = ExpandSettings(width_px=256, anchor_white_cd_m2=1000)
    return compare_methods(panorama, settings, expand(panorama, settings))


def test_every_method_is_there_from_nothing_to_the_model(maps, lamps):
    assert list(maps) == NAMES
    assert np.allclose(maps["ldr"].radiance, lamps / 255, atol=1e-6)
    assert maps["ldr"].anchor is Anchor.RELATIVE
    assert maps["srgb"].anchor is Anchor.LDR_WHITE
    assert maps["expand-2"].anchor is Anchor.LUMINANCE
    assert luminance(maps["srgb"].radiance).max() == pytest.approx(1, rel=1e-3)
    assert luminance(maps["area"].radiance).max() > 1.5


def test_the_picture_has_a_column_for_each_and_shows_what_is_brighter(maps):
    picture = comparison_picture(maps)
    assert picture.dtype == np.uint8
    assert picture.shape[1] > 5 * 320
    columns = [picture[:, 72 + 324 * i : 72 + 324 * i + 320] for i in range(5)]
    # In the darkest row only what is beyond white is left.
    left = [int(column[26 + 2 * 164 : 26 + 3 * 164 - 4].max()) for column in columns]
    assert left[1] < left[4]
    assert left[1] < 120


def test_an_analytic_model_is_not_shown_twice(lamps, capture):
    panorama = Panorama(pixels=lamps, capture=capture)
    settings = ExpandSettings(width_px=256, model="area")
    maps = compare_methods(panorama, settings, expand(panorama, settings))
    assert list(maps) == ["ldr", "srgb", "reinhard", "area"]


def test_the_command_writes_them_beside_the_map(lamps, tmp_path):
    (tmp_path / "room.png").write_bytes(encode_png(lamps))
    out = tmp_path / "out"
    arguments = ["expand", str(tmp_path / "room.png"), "--out", str(out), "--compare"]
    assert main(arguments) == 0
    folder = out / "room.compare"
    assert {path.stem for path in folder.glob("*.exr")} == set(NAMES) - {"expand-2"}
    assert decode_image((folder / "preview.png").read_bytes(), what="preview").ndim == 3
    assert read_environment_map(folder / "srgb.exr").radiance.max() == pytest.approx(1, rel=1e-3)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    record = json.loads((out / "room.json").read_text(encoding="utf-8"))
    assert list(record["files"]) == ["room.exr"]
    (out / "room.json").unlink()
    assert main(arguments) == 0
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before

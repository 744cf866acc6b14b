"""Pairs: the right truth for each map, every protocol, and pictures of both."""

import json

import numpy as np
import pytest

from panokit.capture import Capture, license_from_spdx
from panokit.errors import UsageError
from panokit.io import decode_image, write_environment_map
from panokit.metrics import PROTOCOLS
from panokit.qa import find_items
from panokit.qa.pairs import judge_pairs, match_truths, relit_sheet, score_pair
from panokit.qa.pairs.aligning import align_pair
from panokit.qa.pairs.pictures import SCENES, TILE_PX, difference_scale
from panokit.qa.pairs.scoring import columns, not_scored, summaries


def named(key):
    return Capture(provider="panoramax", id=key, license=license_from_spdx("CC0-1.0", "A"))


@pytest.fixture
def folders(tmp_path, make_map):
    """Two maps, noon and dusk, and truths of noon and of a third place."""
    write_environment_map(make_map(128, sun=3e3, key="n"), tmp_path / "maps/noon.exr")
    write_environment_map(make_map(128, sun=50, key="d"), tmp_path / "maps/dusk.exr")
    write_environment_map(make_map(128, sun=3e4, key="n"), tmp_path / "truth/noon.exr")
    write_environment_map(make_map(128, sun=1e4, key="o"), tmp_path / "truth/other.exr")
    return tmp_path


@pytest.fixture
def items(folders):
    return find_items([folders / "maps"])


def test_maps_without_truth_and_truths_without_map_are_data(folders, items):
    found = match_truths(items, folders / "truth")
    assert {name: path.name for name, path in found.truths.items()} == {"noon": "noon.exr"}
    assert found.without_truth == ("dusk",) and found.unused == ("other.exr",)


def test_a_truth_is_found_by_its_capture(folders, items, make_map):
    write_environment_map(make_map(128, key="d"), folders / "truth/city-17.exr")
    found = match_truths(items, folders / "truth")
    assert found.truths["dusk"].name == "city-17.exr"
    write_environment_map(make_map(128, key="d"), folders / "truth/city-18.exr")
    assert match_truths(items, folders / "truth").without_truth == ("dusk",)  # which of two?


def test_a_truth_is_found_by_its_manifest(folders, items):
    (folders / "truth/manifest.csv").write_text("name,file\ndusk,other.exr\n")
    assert match_truths(items, folders / "truth").truths["dusk"].name == "other.exr"


def test_folders_without_maps_are_told(items, tmp_path):
    with pytest.raises(UsageError, match="no folder"):
        match_truths(items, tmp_path / "nowhere")
    (tmp_path / "empty").mkdir()
    with pytest.raises(UsageError, match="There are no"):
        match_truths(items, tmp_path / "empty")


def test_every_protocol_is_scored_or_told_why_not():
    scored = {column.name for column in columns()}
    assert {name for name, row in PROTOCOLS.items() if row.takes == "maps"} <= scored
    assert set(PROTOCOLS) == (scored & set(PROTOCOLS)) | set(not_scored())
    assert sum(name.startswith("panokit-three-spheres-") for name in scored) == 24
    assert len(scored) == len(columns())


def test_equal_maps_are_perfect_in_every_figure(make_map):
    found = score_pair(make_map(128), make_map(128)).values
    by_name = {column.name: column for column in columns()}
    assert set(found) == set(by_name)
    for name, value in found.items():
        column = by_name[name]
        if value is None or column.better == "higher":
            # A PSNR of equal maps is infinite; SSIM is 1.
            assert value is None or value > 0.99, name
        else:
            best = 1.0 if column.better == "near 1" else 0.0
            assert value == pytest.approx(best, abs=2e-2), name


def test_a_weak_sun_scores_worse_where_it_should(make_map):
    truth = make_map(128, sun=3e4)
    found = score_pair(make_map(128, sun=3e3), truth)
    assert found.values["energy-ratio"] < 0.7
    assert found.values["sun-energy"] < -2
    assert found.values["light-vector"] < 15
    assert found.has_dominant_light and found.dominance > 2
    assert found.values["panokit-three-spheres-diffuse-rmse-fixed"] > 0.05


def test_pairs_are_summarized_apart_where_a_light_dominates(make_map):
    sunny = score_pair(make_map(128, sun=3e3), make_map(128))
    dull = score_pair(make_map(128, sun=1e-6), make_map(128, sun=1e-6))
    assert not dull.has_dominant_light
    both = summaries([sunny, dull])
    alone = summaries([sunny, dull], dominant_only=True)
    assert (both["light-vector"].n, alone["light-vector"].n) == (2, 1)
    assert both["sun-energy"].n + both["sun-energy"].missing == 2
    assert summaries([dull], dominant_only=True)["light-vector"] is None


def test_pairs_are_judged_with_pictures_beside_the_record(folders, items, tmp_path):
    (folders / "truth/dusk.exr").write_bytes(b"broken")
    matches = match_truths(items, folders / "truth")
    seen = []
    found = judge_pairs(items, matches, out=tmp_path / "out", on_judged=seen.append)
    by_name = {score.name: score for score in found.scores}
    assert [score.name for score in seen] == list(by_name)
    assert "dusk.exr" in by_name["dusk"].obstacle and by_name["dusk"].picture == ""
    assert str(folders) not in by_name["dusk"].obstacle
    sheet = decode_image((tmp_path / "out" / by_name["noon"].picture).read_bytes(), what="sheet")
    assert sheet.shape[0] > len(SCENES) * TILE_PX and sheet.shape[1] > 3 * TILE_PX
    record = found.to_json()
    assert record["counts"]["compared"] == 1 and record["counts"]["pairs"] == 2
    text = json.dumps(record, allow_nan=False)
    assert str(tmp_path) not in text and record["unused_truths"] == ["other.exr"]
    assert judge_pairs(items, matches).scores[0].picture == ""


def tile(sheet, scene, column):
    row = SCENES.index(scene) * (TILE_PX + 4)
    return sheet[row : row + TILE_PX, column * (TILE_PX + 4) :][:, :TILE_PX].astype(int)


def test_the_difference_is_gray_where_it_is_right_blue_where_dark_red_where_bright(make_map):
    truth = make_map(128, sun=1e-6)
    right = relit_sheet(align_pair(truth, truth, 128))
    middle = (slice(50, 78), slice(50, 78))
    for scene in SCENES:
        difference = tile(right, scene, 2)[middle]
        assert np.ptp(difference, axis=2).max() <= 3, scene
        np.testing.assert_array_equal(tile(right, scene, 0), tile(right, scene, 1))
    bright = truth.radiance.copy()
    bright[:, 64:] *= 4  # the east; the camera looks north, so light from the right
    pair = align_pair(truth, truth, 128)
    lopsided = type(pair)(
        estimate=pair.estimate * (bright / truth.radiance), truth=pair.truth, gain=1.0
    )
    difference = tile(relit_sheet(lopsided), "mirror", 2)
    east, west = difference[50:78, 100:110], difference[50:78, 18:28]
    assert (east[..., 0] > east[..., 2] + 60).all()
    assert np.ptp(west, axis=2).max() <= 3


def test_the_scale_of_the_difference_runs_from_blue_to_red():
    scale = difference_scale(101, 3)
    assert scale.shape == (3, 101, 3) and scale.dtype == np.uint8
    assert scale[0, 0, 2] > scale[0, 0, 0] and scale[0, -1, 0] > scale[0, -1, 2]
    assert np.ptp(scale[0, 50]) == 0

"""A map among captured maps: an ordinary one is near, an impossible one far; pictures of it."""

import json

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.io import write_environment_map
from panokit.qa import Verdict, check, find_items, qa
from panokit.qa import reference_set as shipped
from panokit.qa.measurements import Measurements
from panokit.qa.plausibility import FIGURES, place, plausibility_figures
from panokit.qa.plausibility_figure import draw_plausibility
from panokit.qa.reference_set import ReferenceSet, own_reference, shipped_reference


def test_a_sunny_place_is_plausible_and_an_even_one_is_not(make_map):
    sunny = check(make_map(512, sun=1e3)).checks[-1]
    assert (sunny.name, sunny.verdict) == ("plausibility", Verdict.PASS)
    assert "outdoor maps" in sunny.note
    even = EnvironmentMap(radiance=np.full((256, 512, 3), 0.5, np.float32))
    assert check(even).checks[-1].verdict is Verdict.FAIL
    assert check(make_map(256)).checks[-1].verdict is Verdict.NOT_APPLICABLE


def test_figures_do_not_depend_on_scale_or_heading(make_map):
    envmap = make_map(512)
    own = plausibility_figures(Measurements(envmap))
    for radiance in (envmap.radiance * np.float32(300), np.roll(envmap.radiance, 64, axis=1)):
        other = plausibility_figures(Measurements(envmap.with_changes(radiance=radiance)))
        assert other == pytest.approx(own, abs=0.01)


def test_the_score_is_the_share_that_lies_farther_out():
    maps = np.repeat(np.linspace(-3, 3, 61)[:, None], len(FIGURES), axis=1)
    reference = ReferenceSet(figures=FIGURES, categories={"all": maps, "far": maps + 50}, source="")
    middle = place(dict.fromkeys(FIGURES, 0.0), reference)
    assert (middle.category, middle.distance, middle.score) == (
        "all",
        0,
        pytest.approx(100 * 60 / 61),
    )
    outside = place(dict.fromkeys(FIGURES, 9.0), reference)
    assert outside.score == 0
    assert outside.percentiles["contrast"] == 100
    odd = place({**dict.fromkeys(FIGURES, 0.0), "anisotropy": -4.0}, reference)
    assert odd.oddest == "anisotropy"


def test_what_ships_is_two_categories_of_finite_figures():
    reference = shipped_reference()
    assert reference.figures == FIGURES
    assert set(reference.categories) == {"indoor", "outdoor"}
    for maps in reference.categories.values():
        assert len(maps) >= 15
        assert np.isfinite(maps).all()
    assert "CC0" in reference.source


def test_damaged_reference_figures_are_told_of(tmp_path):
    (tmp_path / "reference.json").write_text(json.dumps({"schema": "other"}))
    with pytest.raises(UsageError, match="damaged"):
        shipped._read(tmp_path / "reference.json")


def test_few_maps_make_no_reference_of_ones_own():
    figures = [dict.fromkeys(FIGURES, float(number)) for number in range(8)]
    assert own_reference(figures[:7], FIGURES, 8) is None
    assert own_reference([*figures[:7], {}], FIGURES, 8) is None
    assert len(own_reference(figures, FIGURES, 8).categories["reference"]) == 8


def test_a_picture_is_a_png_and_the_same_each_time(make_map):
    figures = plausibility_figures(Measurements(make_map(512)))
    first, again = (draw_plausibility(figures, shipped_reference(), "noon") for _ in range(2))
    assert first.startswith(b"\x89PNG")
    assert first == again


def test_pictures_are_drawn_on_request(make_map, tmp_path):
    write_environment_map(make_map(512), tmp_path / "maps/noon.exr")
    items = find_items([tmp_path / "maps"])
    qa(items, out=tmp_path / "out")
    assert not (tmp_path / "out/plausibility").exists()
    qa(items, out=tmp_path / "out", pictures=True)
    assert (tmp_path / "out/plausibility/noon.png").read_bytes().startswith(b"\x89PNG")

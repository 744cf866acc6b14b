"""Undamaged maps pass; each kind of damage is flagged by the check that is meant for it."""

import json

import numpy as np
import OpenEXR
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError
from panokit.io import read_environment_map
from panokit.provenance import Provenance
from panokit.qa import QaSettings, Report, Verdict, check, judge
from panokit.qa.checks import RULES
from panokit.sphere import equirect_directions, resize_radiance


def failed(envmap):
    return {c.name for c in check(envmap).failed}


@pytest.mark.parametrize("width", [128, 256, 1024])
@pytest.mark.parametrize("sun", [10, 3e4])
def test_an_undamaged_map_passes(make_map, width, sun):
    assert failed(make_map(width, sun=sun)) == set()


@pytest.mark.parametrize("shift", [1, 37, 100, 200])
def test_it_passes_at_any_heading(make_map, shift):
    envmap = make_map()
    assert failed(envmap.with_changes(radiance=np.roll(envmap.radiance, shift, axis=1))) == set()


@pytest.mark.parametrize("scale", [1e-25, 1e-3, 1e3, 1e30])
def test_figures_of_shape_do_not_depend_on_the_scale(make_map, scale):
    envmap = make_map(256)
    scaled = envmap.with_changes(radiance=envmap.radiance * np.float32(scale))
    for name in ("dynamic-range", "top-share", "wrap-seam", "poles", "clipped-area"):
        found = check(scaled).values[name]
        assert found == pytest.approx(check(envmap).values[name], rel=1e-3, abs=1e-4), name


@pytest.mark.parametrize("column", [0, -1])
def test_a_seam_of_one_pixel_is_flagged(make_map, column):
    envmap = make_map()
    radiance = envmap.radiance.copy()
    radiance[:, column] *= np.float32(0.8)
    assert "wrap-seam" in failed(envmap.with_changes(radiance=radiance))


def test_a_jump_at_the_seam_is_flagged(make_map):
    # Exposure drifts by a third of a stop from the left edge to the right.
    envmap = make_map()
    drift = np.linspace(1, 1.26, envmap.width_px, dtype=np.float32)[None, :, None]
    assert "wrap-seam" in failed(envmap.with_changes(radiance=envmap.radiance * drift))


def test_the_same_column_inside_the_picture_is_not_a_seam(make_map):
    envmap = make_map()
    radiance = envmap.radiance.copy()
    radiance[:, 60] *= np.float32(0.8)
    assert "wrap-seam" not in failed(envmap.with_changes(radiance=radiance))


@pytest.mark.parametrize("pole", ["zenith", "nadir"])
def test_a_pinwheel_at_a_pole_is_flagged(make_map, pole):
    # Rows that repeat the row at 20 degrees from the pole, as a flat fill leaves them.
    envmap = make_map()
    radiance = envmap.radiance.copy()
    spread = 1 + np.sin(np.arange(256) / 256 * 80 * np.pi)[None, :, None].astype(np.float32) * 0.5
    rows = slice(0, 25) if pole == "zenith" else slice(-25, None)
    radiance[rows] *= spread
    assert failed(envmap.with_changes(radiance=radiance)) >= {"poles"}


def test_noise_in_a_map_too_small_for_a_pinwheel_is_none(make_map):
    small = make_map(128)
    grain = np.random.default_rng(0).uniform(0.5, 2, small.radiance.shape).astype(np.float32)
    report = check(small.with_changes(radiance=small.radiance * grain))
    assert report.values["poles"] is None
    assert check(make_map(256)).values["poles"] is not None


def test_an_edge_that_crosses_a_pole_is_no_pinwheel(make_map):
    envmap = make_map()
    bright = np.where(equirect_directions(256, 128)[..., :1] > 0, np.float32(3), np.float32(1))
    assert "poles" not in failed(envmap.with_changes(radiance=envmap.radiance * bright))


def test_display_values_are_flagged_for_their_range(make_map):
    # What is left when somebody forgets to expand: no more than 1.0, and flat where it clipped.
    envmap = make_map()
    clipped = envmap.with_changes(radiance=np.minimum(envmap.radiance, np.float32(1)) ** (1 / 2.4))
    assert failed(clipped) >= {"dynamic-range", "clipped-area"}


def test_a_clipped_source_is_flagged(make_map):
    envmap = make_map()
    assert "clipped-area" in failed(envmap.with_changes(radiance=np.minimum(envmap.radiance, 10)))


def test_even_light_is_flagged():
    even = EnvironmentMap(radiance=np.ones((64, 128, 3), np.float32))
    assert failed(even) == {"dynamic-range", "top-share", "clipped-area"}


def test_a_black_map_fails_and_what_cannot_be_measured_is_not_applicable():
    report = check(EnvironmentMap(radiance=np.zeros((32, 64, 3), np.float32)))
    verdicts = {c.name: c.verdict for c in report.checks}
    assert verdicts["energy"] is Verdict.FAIL
    assert verdicts["dynamic-range"] is Verdict.NOT_APPLICABLE
    assert verdicts["top-share"] is Verdict.NOT_APPLICABLE


def test_changed_energy_is_flagged_against_the_ledger(make_map):
    envmap = make_map()
    brighter = envmap.with_changes(radiance=envmap.radiance * np.float32(1.01))
    assert failed(brighter) == {"energy-ledger"}
    assert check(brighter).values["energy-ledger"] == pytest.approx(0.01, rel=1e-3)


def test_a_resize_that_loses_energy_is_flagged_and_ours_is_not(make_map):
    envmap = make_map()
    assert "energy-ledger" not in failed(
        envmap.with_changes(radiance=resize_radiance(envmap.radiance, 128))
    )
    picked = np.ascontiguousarray(envmap.radiance[::2, ::2])
    assert "energy-ledger" in failed(envmap.with_changes(radiance=picked))


def test_without_a_recorded_energy_the_ledger_does_not_apply(make_map):
    report = check(make_map().with_changes(provenance=Provenance()))
    assert report.values["energy-ledger"] is None
    assert report.verdict is Verdict.PASS


def test_top_share_is_exact_on_a_map_of_two_levels():
    # A cap that covers 0.1 % of the sphere and shines 99 times as bright as the rest.
    radiance = np.ones((512, 1024, 3), np.float32)
    radiance[:10] = 99
    covered = (1 - np.cos(np.pi * 10 / 512)) / 2
    energy = 99 * covered + (1 - covered)
    share = 99 * min(covered, 1e-3) / energy + max(0, 1e-3 - covered) / energy
    assert check(EnvironmentMap(radiance=radiance)).values["top-share"] == pytest.approx(share)


def test_a_patch_of_nan_does_not_get_past_reading(make_map, tmp_path):
    radiance = make_map().radiance.copy()
    radiance[50:53, 60:64] = np.nan
    # panokit does not write such a file; other programs do.
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGB": radiance}) as file:
        file.write(str(tmp_path / "patch.exr"))
    with pytest.raises(ImageError, match="36 nan"):
        read_environment_map(tmp_path / "patch.exr")


def test_a_verdict_is_recomputed_from_the_figures_under_other_settings(make_map):
    report = check(make_map())
    strict = QaSettings(dynamic_range_min_stops=25)
    again = judge(report.values, strict)
    assert report.verdict is Verdict.PASS
    assert [c.name for c in again.failed] == ["dynamic-range"]
    assert judge(report.values) == report
    assert again.settings_digest != report.settings_digest


def test_a_report_survives_json(make_map):
    report = check(make_map())
    again = Report.from_json(json.loads(json.dumps(report.to_json())))
    assert again.values == report.values
    assert again.to_json() == report.to_json()


def test_a_figure_that_is_not_a_number_fails():
    assert judge({"wrap-seam": float("nan")}).failed[0].name == "wrap-seam"


@pytest.mark.data
@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("kloofendal_overcast_1k", set()),
        ("street_lamp_1k", set()),
        ("sunny_vondelpark_1k", set()),
        ("artist_workshop_1k", set()),
        ("vintage_measuring_lab_1k", {"clipped-area"}),
    ],
)
def test_captured_probes(shared_data, name, expected):
    (path,) = (shared_data / "probes").glob(f"{name}.*")
    assert failed(read_environment_map(path)) == expected


FIGURE = st.none() | st.floats(allow_nan=True, allow_infinity=True, width=32)


@settings(deadline=None)
@given(st.fixed_dictionaries({rule.name: FIGURE for rule in RULES}))
def test_verdicts_follow_from_stored_figures_alone(values):
    report = judge(values, notes={"tilt": "by upright lines"})
    again = Report.from_json(json.loads(json.dumps(report.to_json())))
    assert [c.verdict for c in again.checks] == [c.verdict for c in report.checks]
    assert [c.verdict for c in judge(again.values).checks] == [c.verdict for c in report.checks]
    assert again.notes == {"tilt": "by upright lines"}


def test_every_check_has_a_family_a_meaning_and_a_limit():
    report = judge({})
    assert {c.family for c in report.checks} == {
        "radiometry", "geometry", "content", "sun", "plausibility",
    }  # fmt: skip
    assert all(c.meaning.endswith(".") for c in report.checks)
    assert all(c.low is not None or c.high is not None for c in report.checks)
    assert len({c.name for c in report.checks}) == len(report.checks)


def test_what_does_not_apply_says_why(make_map):
    report = check(make_map(64).with_changes(capture=None, provenance=Provenance()))
    silent = [c for c in report.checks if c.verdict is Verdict.NOT_APPLICABLE]
    assert len(silent) > 5
    assert all(c.note for c in silent)

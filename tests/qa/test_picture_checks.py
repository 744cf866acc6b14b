"""Sharpness, empty and filled areas, level, the seam's twin: sound pass, damaged fail."""

import cv2
import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.frames import Rotation
from panokit.provenance import Provenance, Step
from panokit.qa import Verdict, check
from panokit.sphere import equirect_directions, resize_radiance, rotate_radiance


def of(envmap, name):
    return next(c for c in check(envmap).checks if c.name == name)


@pytest.fixture
def town():
    """Houses with upright edges all around, under a sky, 1024 wide."""
    directions = equirect_directions(1024, 512)
    azimuth = np.degrees(np.arctan2(directions[..., 0], -directions[..., 2]))
    elevation = np.degrees(np.arcsin(directions[..., 1]))
    house = np.floor(azimuth / 9).astype(int) % 40
    rng = np.random.default_rng(4)
    walls, heights = rng.uniform(0.1, 0.9, 40), rng.uniform(12, 40, 40)
    radiance = np.where(elevation > heights[house], 1.5, walls[house])
    radiance = np.where(elevation < -15, 0.25, radiance)
    grain = 1 + 0.02 * rng.normal(size=radiance.shape) * (np.abs(elevation) < 60)
    return EnvironmentMap(
        radiance=np.repeat((radiance * grain)[..., None], 3, axis=2).astype(np.float32)
    )


def test_a_level_map_is_level_by_its_houses(town):
    found = of(town, "tilt")
    assert found.verdict is Verdict.PASS
    assert found.value < 0.5
    assert "upright lines" in found.note


@pytest.mark.parametrize("axis", [(1, 0, 0), (0.6, 0, -0.8)])
def test_a_tilt_of_five_degrees_is_found_and_measured(town, axis):
    turn = Rotation.about_axis(axis, np.deg2rad(5))
    found = of(town.with_changes(radiance=rotate_radiance(town.radiance, turn)), "tilt")
    assert found.verdict is Verdict.FAIL
    assert found.value == pytest.approx(5, abs=0.7)


def test_the_horizon_of_a_sea_tells_as_well():
    y = equirect_directions(512, 256)[..., 1:2]
    sea = (np.where(y > 0, [0.5, 0.7, 1.0], [0.1, 0.15, 0.2])).astype(np.float32)
    level = of(EnvironmentMap(radiance=sea), "tilt")
    assert level.value == 0
    assert "horizon" in level.note
    turn = Rotation.about_axis((0, 0, 1), np.deg2rad(5))
    tilted = of(EnvironmentMap(radiance=rotate_radiance(sea, turn)), "tilt")
    assert tilted.value == pytest.approx(5, abs=1)


def test_a_map_without_lines_or_horizon_says_nothing(make_map):
    clouds = make_map(512).radiance * 0 + 1
    assert of(EnvironmentMap(radiance=clouds), "tilt").verdict is Verdict.NOT_APPLICABLE


@pytest.mark.parametrize("enlarge", ["linear", "cubic"])
def test_a_map_enlarged_from_half_its_size_is_not_sharp(town, enlarge):
    assert of(town, "sharpness").verdict is Verdict.PASS
    half = resize_radiance(town.radiance, 512)
    large = (
        resize_radiance(half, 1024)
        if enlarge == "linear"
        else np.maximum(cv2.resize(half, (1024, 512), interpolation=cv2.INTER_CUBIC), 0)
    )
    assert of(EnvironmentMap(radiance=large), "sharpness").verdict is Verdict.FAIL


def test_where_there_is_no_detail_sharpness_cannot_be_told(make_map):
    flat = EnvironmentMap(radiance=np.ones((256, 512, 3), np.float32))
    assert of(flat, "sharpness").verdict is Verdict.NOT_APPLICABLE
    assert of(make_map(128), "sharpness").verdict is Verdict.NOT_APPLICABLE


def test_black_padding_is_an_empty_area(town):
    assert of(town, "empty-area").value == 0
    padded = np.zeros_like(town.radiance)
    padded[:256, :512] = resize_radiance(town.radiance, 512)
    found = of(EnvironmentMap(radiance=padded), "empty-area")
    assert found.verdict is Verdict.FAIL
    assert found.value == pytest.approx(75, abs=1)


def inpainted(envmap, *holes):
    described = [
        {"kind": kind, "solid_angle_sr": area, "confidence": 1.0, "filled": filled}
        for kind, area, filled in holes
    ]
    step = Step(stage="inpaint", version="1", values={"holes": described})
    return envmap.with_changes(provenance=Provenance((step,)))


def test_holes_left_and_holes_filled_are_read_from_the_record(town):
    percent = 4 * np.pi / 100
    envmap = inpainted(town, ("nadir", 2 * percent, True), ("missing", 1 * percent, False))
    left, made_up = of(envmap, "hole-area"), of(envmap, "filled-area")
    assert (left.value, left.verdict, left.note) == (pytest.approx(1), Verdict.FAIL, "missing")
    assert (made_up.value, made_up.verdict) == (pytest.approx(2), Verdict.PASS)
    assert of(inpainted(town), "hole-area").value == 0
    assert of(town, "hole-area").verdict is Verdict.NOT_APPLICABLE
    mostly = inpainted(town, ("sky", 40 * percent, True))
    assert of(mostly, "filled-area").verdict is Verdict.FAIL


def test_a_last_column_that_repeats_the_first_is_seen(town):
    assert of(town, "seam-repeat").verdict is Verdict.PASS
    repeated = town.radiance.copy()
    repeated[:, -1] = repeated[:, 0]
    assert of(EnvironmentMap(radiance=repeated), "seam-repeat").verdict is Verdict.FAIL

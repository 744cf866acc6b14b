"""What is learned from beside the probes: clipped probes, computed light, tilts."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from panokit.train.probes import read_lower_bounds, read_probes
from panokit.train.recipe import DataRecipe, SyntheticRecipe

pytestmark = pytest.mark.train
pytest.importorskip("torch")
PLAIN = DataRecipe(shots_per_probe=1)


@pytest.fixture(autouse=True)
def _small_maps(monkeypatch: pytest.MonkeyPatch):
    from panokit.evaluate import probe_set
    from panokit.train import sources

    monkeypatch.setattr(probe_set, "PROBE_WIDTH_PX", 256)
    monkeypatch.setattr(sources, "PROBE_WIDTH_PX", 256)


def test_clipped_probes_are_listed_apart(probe_folder: Path):
    assert [probe.name for probe in read_lower_bounds(probe_folder)] == ["map5"]
    assert "map5" not in [probe.name for probe in read_probes(probe_folder)]


def test_a_clipped_probe_gives_pictures_whose_lamp_is_a_lower_bound(probe_folder, tmp_path):
    from panokit.train.examples import make_examples
    from panokit.train.sources import NOWHERE, other_sources

    probes = read_probes(probe_folder)
    recipe = PLAIN.model_copy(update={"lower_bounds": True})
    others = other_sources(probes, recipe, probe_folder, tmp_path)
    assert [(o.map.name, o.kind, o.place) for o in others] == [("map5", "bound", NOWHERE)]
    found = make_examples(probes, recipe, others=others)
    plain = make_examples(probes, PLAIN)
    count = len(plain.probe)
    assert np.array_equal(found.grid[:count], plain.grid)
    assert not found.ceiling[:count].any() and not found.lower[:count].any()
    # Only the lamp is as bright as the map can be.
    assert 0 < (found.ceiling[count] > 0).mean() < 0.05
    assert found.lower[count].sum() == 1
    assert found.energy[count][found.lower[count] == 1] == found.energy[count].max()
    # It is nobody's place, so it stays in every fold.
    assert found.of_probes(np.array([2])).probe.tolist() == [2, NOWHERE]


def test_a_clipped_probe_of_a_judged_place_stays_in_that_place_s_fold(probe_folder, tmp_path):
    from panokit.train.sources import other_sources

    probes = read_probes(probe_folder)
    third = replace(probes[3], group=read_lower_bounds(probe_folder)[0].group)
    recipe = PLAIN.model_copy(update={"lower_bounds": True})
    others = other_sources([*probes[:3], third], recipe, probe_folder, tmp_path)
    assert [o.place for o in others] == [3]


def test_tilted_pictures_are_others_and_the_same_each_time(probe_folder):
    from panokit.train.examples import make_examples

    probes = read_probes(probe_folder)[:2]
    recipe = PLAIN.model_copy(update={"tilt_deg": 20.0})
    tilted, plain = make_examples(probes, recipe), make_examples(probes, PLAIN)
    again = make_examples(probes, recipe)
    assert np.array_equal(tilted.grid, again.grid)
    assert not np.array_equal(tilted.grid, plain.grid)


def test_a_tilt_is_small_about_a_level_axis_and_keeps_all_light(probe_folder):
    from panokit.sphere import energy, rotate_radiance
    from panokit.train.examples import _tilt

    assert _tilt(0.0, 1) is None
    tilts = [_tilt(20.0, seed) for seed in range(50)]
    up = np.array([0.0, 1.0, 0.0])
    # About a level axis, the zenith moves by the whole angle.
    angles = np.degrees([np.arccos(np.clip(up @ t.apply(up), -1, 1)) for t in tilts])
    assert angles == pytest.approx(np.degrees([abs(t.angle) for t in tilts]), abs=1e-3)
    assert 15 < angles.max() <= 20 and angles.min() < 5
    radiance = read_probes(probe_folder)[0].radiance()
    assert energy(rotate_radiance(radiance, tilts[0])) == pytest.approx(energy(radiance), rel=1e-4)


def test_pictures_are_drawn_by_their_weight(probe_folder):
    from panokit.train.examples import make_examples

    examples = make_examples(read_probes(probe_folder)[:3], PLAIN)
    even = examples.draw(6, np.random.default_rng(3))
    assert np.array_equal(even, np.random.default_rng(3).integers(3, size=6))
    weighted = replace(examples, weight=np.array([1, 0, 3], np.float32))
    drawn = weighted.draw(4000, np.random.default_rng(0))
    assert np.bincount(drawn, minlength=3) / 4000 == pytest.approx([0.25, 0, 0.75], abs=0.03)


@pytest.mark.render
def test_skies_are_made_once_and_are_drawn_as_often_as_asked(probe_folder, tmp_path, monkeypatch):
    pytest.importorskip("mitsuba")
    from panokit.sphere import equirect_directions, irradiance
    from panokit.train import examples, synthetic_light
    from panokit.train.examples import make_examples
    from panokit.train.sources import NOWHERE, other_sources

    monkeypatch.setattr(synthetic_light, "OUTDOORS", ("outdoor",))
    monkeypatch.setattr(synthetic_light, "SKY_WIDTH_PX", 256)
    # So small and bright a sky hides much of its sun.
    monkeypatch.setattr(examples, "SUN_GAIN", 1.0)
    monkeypatch.setattr(examples, "SUN_SHARE", 0.0)
    probes = read_probes(probe_folder)
    synthetic = SyntheticRecipe(skies=1, grounded=1, shots_per_map=2, share=0.25)
    recipe = PLAIN.model_copy(update={"synthetic": synthetic})
    others = other_sources(probes, recipe, probe_folder, tmp_path)
    assert [o.kind for o in others] == ["synthetic"] * 2
    place = others[1].place
    assert others[0].place == NOWHERE and probes[place].category == "outdoor"
    before = others[0].map.path.stat().st_mtime_ns
    assert other_sources(probes, recipe, probe_folder, tmp_path) == others
    assert others[0].map.path.stat().st_mtime_ns == before

    sky = others[0].radiance()
    directions = equirect_directions(256, 128)
    sun = np.unravel_index(int(sky[..., 1].argmax()), sky.shape[:2])
    assert sky.max() > 1000 * np.median(sky)
    assert directions[sun][1] > 0.03
    # The ground gives back a part of what it receives.
    received = irradiance(sky, np.array([[0.0, 1.0, 0.0]]))[0]
    albedo = np.pi * np.median(sky[100:], axis=(0, 1)) / received
    assert (albedo > 0.04).all() and (albedo < 0.5).all()
    # The other one's ground is that of its probe, but for its scale.
    grounded, own = others[1].radiance()[75:], probes[place].radiance()[75:]
    ratio = grounded / own
    assert ratio.std() / ratio.mean() < 0.02

    found = make_examples(probes, recipe, others=others)
    assert found.probe[-4:].tolist() == [NOWHERE, NOWHERE, place, place]
    assert found.weight[-4:].sum() / found.weight.sum() == pytest.approx(0.25)
    # A sky by day is one in which the sun can be; the lamps of the probes are none.
    assert found.sun[-4:].any()
    assert not found.sun[:-4].any()


@pytest.mark.slow
@pytest.mark.render
def test_a_rendered_place_has_light_from_all_sides(tmp_path):
    pytest.importorskip("mitsuba")
    from panokit.synthetic.settings import CitySettings
    from panokit.synthetic.shots import plan_shots
    from panokit.train.synthetic_light import render_place

    (shot,) = plan_shots(CitySettings(count=1, seed=11))
    assert shot.weather == "clear"
    light = render_place(shot, SyntheticRecipe(places=1, width_px=64, samples=2))
    assert light.shape == (32, 64, 3) and np.isfinite(light).all()
    assert (light > 0).mean() > 0.9

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from panokit.expand.network import ExpansionNetwork, compose, predict
from panokit.expand.reduce import reduce_panorama
from panokit.train.examples import Examples, load_examples, make_examples, save_examples
from panokit.train.probes import read_probes
from panokit.train.recipe import Recipe
from panokit.weights import read_model

pytestmark = pytest.mark.train
torch = pytest.importorskip("torch")

TINY = Recipe.model_validate(
    {
        "id": "tiny",
        "grid_weight": 0.25,
        "data": {"shots_per_probe": 1},
        "network": {"members": 1, "steps": 3, "batch": 2},
        "components": {"members": 1, "steps": 5, "batch": 4},
    }
)


@pytest.fixture(scope="module")
def examples(probe_folder: Path) -> Examples:
    return make_examples(read_probes(probe_folder), TINY.data)


def test_examples_balance_light_and_come_back_from_disk(examples: Examples, tmp_path: Path):
    save_examples(examples, tmp_path / "e.npz")
    again = load_examples(tmp_path / "e.npz")
    for field in fields(Examples):
        assert np.array_equal(getattr(again, field.name), getattr(examples, field.name))
    assert (examples.ldr_energy[:, 0] > 0).all()
    # The lamp is brighter than the picture shows, and its irradiance is a share of its energy.
    assert (examples.energy > 2 * examples.ldr_energy).any(axis=1).mean() > 0.7
    assert examples.spread[:, 0].max() <= 1.0001
    assert len(examples.of_probes(np.array([1, 3])).probe) == 2


def test_the_light_of_components_and_rest_is_the_light_of_the_map(examples: Examples):
    from panokit.train.normals import irradiance_matrix

    linear = np.exp(examples.clear.astype(np.float64)) + np.exp(examples.burnt.astype(np.float64))
    light = np.tensordot([0.2126, 0.7152, 0.0722], linear, axes=(0, 1)).reshape(len(linear), -1)
    whole = light @ irradiance_matrix(128, 64).T
    parts = np.einsum("bk,bkn->bn", examples.energy, examples.spread) + examples.rest[:, :64]
    assert parts == pytest.approx(whole[:, :64], rel=0.03)
    assert examples.energy.sum(1) + examples.rest[:, 67] == pytest.approx(whole[:, 67], rel=0.02)


def test_wide_and_mixed_pictures_are_added_to_the_plain_ones(probe_folder: Path):
    from panokit.train.recipe import DataRecipe

    recipe = DataRecipe(shots_per_probe=1, wide_per_probe=1, mixed_per_probe=1)
    probes = read_probes(probe_folder)[:2]
    found = make_examples(probes, recipe)
    assert found.probe.tolist() == [0, 0, 0, 1, 1, 1]
    plain = make_examples(probes, TINY.data)
    assert np.array_equal(found.features[[0, 3]], plain.features)
    assert not np.array_equal(found.features[[1, 4]], plain.features)


def test_a_mixed_probe_has_the_light_of_two_of_its_own_fold(probe_folder: Path):
    from panokit.train.examples import _leveled, _mixed
    from panokit.train.probes import FOLDS, assign_folds

    # Two probes of one group are in one fold; alone in its fold, a probe mixes with itself.
    probes = read_probes(probe_folder)
    folds = assign_folds(probes, FOLDS)
    assert folds[0] == folds[1]
    assert (folds[2:] != folds[0]).any()
    own, other = (_leveled(probes[i].radiance()) for i in (0, 1))
    added = _mixed(0, probes, 0) - own
    share = added.sum() / other.sum()
    assert 0.1 <= share <= 1
    # A turn and a mirror image keep each row's sum.
    assert added.sum(axis=1) == pytest.approx(share * other.sum(axis=1), rel=2e-2, abs=1e-2)


def test_the_sun_is_the_strongest_light_of_a_daylight_scene(examples: Examples, probe_folder: Path):
    # The tiny world's scenes are of no kind in which the sun can be; say that one is.
    assert not examples.sun.any()
    bright = read_probes(probe_folder)[4]
    found = make_examples([replace(bright, category="outdoor_sunny")], TINY.data)
    assert found.sun.sum() == 1
    assert found.energy[found.sun == 1] == found.energy.max()


def test_finding_the_sun_costs_nothing_where_it_is_certain():
    from panokit.train.losses import sun_loss

    sun, energy = torch.tensor([[1.0, 0.0, 0.0]]), torch.tensor([[2.0, 1.0, 0.0]])
    right, wrong = torch.tensor([[9.0, -9.0, 9.0]]), torch.tensor([[-9.0, 9.0, 0.0]])
    assert float(sun_loss(right, sun, energy)) < 0.01
    assert float(sun_loss(wrong, sun, energy)) > 10


def test_the_loss_is_least_at_the_truth(examples: Examples):
    from panokit.train.losses import GridLoss

    loss_of = GridLoss()
    grid = torch.from_numpy(examples.grid).float()
    clear, burnt = (torch.from_numpy(getattr(examples, n)).float() for n in ("clear", "burnt"))
    right = (burnt.exp() / grid[:, 6:9].clamp(min=1e-4)).clamp(min=1).log()
    slopes = torch.ones(len(grid), 2)
    best = float(sum(loss_of(grid, right, slopes, clear, burnt).values()))
    for offset in (-1.0, 1.0):
        assert float(sum(loss_of(grid, right + offset, slopes, clear, burnt).values())) > best + 0.5


@pytest.mark.parametrize("kind", ["gain", "components"])
def test_training_repeats_and_resumes_from_a_checkpoint(
    examples: Examples, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
):
    from panokit.train import loop
    from panokit.train.run import Run

    def fit(checkpoint: Path | None = None):
        if kind == "gain":
            return loop.train_gain_net(examples, TINY.network, seed=4, checkpoint=checkpoint)
        return loop.train_component_net(examples, TINY.components, seed=4, checkpoint=checkpoint)

    monkeypatch.setattr(loop, "CHECKPOINT_EVERY", 1)
    whole = fit()
    path = tmp_path / "net.pt"
    stopped_after = 2
    original = Run.save

    def save_and_stop(run, where):
        original(run, where)
        if run.step == stopped_after:
            raise KeyboardInterrupt

    monkeypatch.setattr(Run, "save", save_and_stop)
    with pytest.raises(KeyboardInterrupt):
        fit(path)
    # What else is random in the process must not matter.
    torch.manual_seed(12345)
    monkeypatch.setattr(Run, "save", original)
    resumed = fit(path)
    for name, value in whole.state_dict().items():
        assert torch.equal(value, resumed.state_dict()[name]), name
    # A finished run is not made again.
    monkeypatch.setattr(Run, "advance", None)
    finished = fit(path)
    for name, value in whole.state_dict().items():
        assert torch.equal(value, finished.state_dict()[name]), name


def test_a_checkpoint_that_does_not_fit_is_refused(examples: Examples, tmp_path: Path):
    from panokit.errors import ModelError
    from panokit.train.loop import train_component_net

    path = tmp_path / "net.pt"
    path.write_bytes(b"not a checkpoint")
    with pytest.raises(ModelError, match="Delete it"):
        train_component_net(examples, TINY.components, seed=0, checkpoint=path)


def test_a_trained_recipe_is_released_and_expands_a_picture(examples: Examples, tmp_path: Path):
    from panokit.train.ensemble import train_ensemble
    from panokit.train.release import release

    release(TINY, train_ensemble(examples, TINY, tmp_path / "work"), tmp_path / "tiny")
    model = read_model(tmp_path / "tiny")
    network = ExpansionNetwork(model)
    pixels = np.full((128, 256, 3), 80, np.uint8)
    pixels[40:44, 30:35] = 255
    reduced = reduce_panorama(pixels, 256)
    radiance = compose(reduced, predict(reduced, network))
    assert radiance[42, 32].min() > 1
    turned = reduce_panorama(np.roll(pixels, 2 * 8, axis=1), 256)
    again = compose(turned, predict(turned, network))
    assert again == pytest.approx(np.roll(radiance, 16, axis=1), rel=2e-3)
    # Where nothing is burnt out, nothing is invented.
    plain = reduce_panorama(np.full((128, 256, 3), 200, np.uint8), 256)
    assert len(predict(plain, network).components) == 0
    assert compose(plain, predict(plain, network)).max() < 1
    assert model.files["expansion"].inputs == ("grid", "features")
    assert predict(reduced, network).grid_weight == TINY.grid_weight


def test_a_file_that_computes_something_else_is_not_released():
    from panokit.errors import ModelError
    from panokit.train.release import _check_parity

    expected = np.array([0.5, -8.0], np.float32)
    _check_parity("x.onnx", "log_gain", expected + np.float32(4e-5), expected, 1e-5)
    with pytest.raises(ModelError, match="log_gain differs"):
        _check_parity("x.onnx", "log_gain", expected + np.float32(2e-4), expected, 1e-5)

from dataclasses import fields
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


def test_the_loss_is_least_at_the_truth(examples: Examples):
    from panokit.train.losses import GridLoss

    loss_of = GridLoss()
    grid = torch.from_numpy(examples.grid).float()
    clear, burnt = (torch.from_numpy(getattr(examples, n)).float() for n in ("clear", "burnt"))
    right = (burnt.exp() / grid[:, 6:9].clamp(min=1e-4)).clamp(min=1).log()
    slopes = torch.ones(len(grid), 2)
    best = float(loss_of(grid, right, slopes, clear, burnt))
    for offset in (-1.0, 1.0):
        assert float(loss_of(grid, right + offset, slopes, clear, burnt)) > best + 0.5


def test_training_repeats_and_resumes_from_a_checkpoint(
    examples: Examples, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    from panokit.train import loop

    monkeypatch.setattr(loop, "CHECKPOINT_EVERY", 1)
    whole = loop.train_gain_net(examples, TINY.network, seed=4)
    path = tmp_path / "gain.pt"

    stopped_after = 2
    original = loop._Run.save

    def save_and_stop(run, where):
        original(run, where)
        if run.step == stopped_after:
            raise KeyboardInterrupt

    monkeypatch.setattr(loop._Run, "save", save_and_stop)
    with pytest.raises(KeyboardInterrupt):
        loop.train_gain_net(examples, TINY.network, seed=4, checkpoint=path)
    monkeypatch.setattr(loop._Run, "save", original)
    resumed = loop.train_gain_net(examples, TINY.network, seed=4, checkpoint=path)
    for name, value in whole.state_dict().items():
        assert torch.equal(value, resumed.state_dict()[name]), name


def test_a_trained_recipe_is_released_and_expands_a_picture(examples: Examples, tmp_path: Path):
    from panokit.train.ensemble import train_ensemble
    from panokit.train.release import release

    release(TINY, *train_ensemble(examples, TINY, tmp_path / "work"), tmp_path / "tiny")
    model = read_model(tmp_path / "tiny")
    network = ExpansionNetwork(model)
    pixels = np.full((128, 256, 3), 80, np.uint8)
    pixels[40:44, 30:35] = 255
    reduced = reduce_panorama(pixels, 256)
    radiance = compose(reduced, predict(reduced, network))
    assert radiance[42, 32].min() > 1
    turned = reduce_panorama(np.roll(pixels, 2 * 5, axis=1), 256)
    again = compose(turned, predict(turned, network))
    assert again == pytest.approx(np.roll(radiance, 10, axis=1), rel=2e-3)


def test_the_area_rule_is_recovered_from_examples_that_follow_it(examples: Examples):
    from dataclasses import replace

    from panokit.train.area_rule import fit_area_rule

    gain = np.exp(0.3 - 0.6 * examples.features[..., 0])
    follows = replace(examples, energy=(examples.ldr_energy * gain).astype(np.float32))
    rule = fit_area_rule(follows)
    assert (rule.offset, rule.slope) == pytest.approx((0.3, -0.6), abs=0.01)

"""Training of lighting networks: it learns, it goes on where it stopped, and it is released."""

import json
from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from panokit.evaluate.lighting.predictors import NetworkPredictor  # noqa: E402
from panokit.evaluate.lighting.sample import sample_of  # noqa: E402
from panokit.networks.stereo.settings import StereoNetSettings  # noqa: E402
from panokit.train.stereo import loop  # noqa: E402
from panokit.train.stereo.loop import has_converged, train_lighting  # noqa: E402
from panokit.train.stereo.losses import MapLoss, render_difference  # noqa: E402
from panokit.train.stereo.pack import Pack  # noqa: E402
from panokit.train.stereo.recipe import (  # noqa: E402
    LightingRecipe,
    LossRecipe,
    NormalsRecipe,
    ScheduleRecipe,
)
from panokit.train.stereo.release import release_lighting  # noqa: E402
from panokit.train.stereo.tasks import batch_of, build_network  # noqa: E402

pytestmark = pytest.mark.train
TINY = LightingRecipe(
    id="tiny",
    network=StereoNetSettings(width=4, input_px=32),
    schedule=ScheduleRecipe(epochs=3, batch=4, learning_rate=3e-3),
)
KINDS = ("stereo", "dematerial", "dense-reflectance", "picture-reflectance")


def halves(pack):
    """Eight samples to learn from, four to look at."""
    parts = (slice(0, 8), slice(8, 12))
    return [
        Pack(keys=pack.keys[p], places=pack.places[p],
             arrays={name: values[p] for name, values in pack.arrays.items()})
        for p in parts
    ]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_learns(kind, pack, tmp_path):
    recipe = TINY.model_copy(update={"kind": kind, "normals": NormalsRecipe(noise_deg=5)})
    training, validation = halves(pack)
    network = train_lighting(recipe, training, validation, tmp_path)
    lines = [json.loads(x) for x in (tmp_path / "history.jsonl").read_text().splitlines()]
    assert [line["step"] for line in lines] == [2, 4, 6]
    assert lines[-1]["loss"] < lines[0]["loss"]
    assert {"loss", "l1", "validation", "ssd"} <= set(lines[0])
    assert not network.training


EVERYTHING = StereoNetSettings(
    width=4, input_px=32, wrap=True, window=True, lights=2, dropout=0.2, pyramid=True
)


@pytest.mark.parametrize(
    "changes", [{"kind": "stereo"}, {"kind": "dematerial"}, {"network": EVERYTHING}]
)
def test_a_released_model_predicts_what_torch_does(changes, pack, members, tmp_path):
    recipe = TINY.model_copy(update=changes)
    torch.manual_seed(1)
    network = build_network(recipe).eval()
    release_lighting(recipe, network, tmp_path / "model")
    predictor = NetworkPredictor(tmp_path / "model")
    found = predictor.predict(sample_of(members[3]))
    inputs, _ = batch_of(recipe, pack, np.array([3]), 0)
    with torch.inference_mode():
        code = network(*(2 * one - 1 for one in inputs.values()))
    expected = recipe.coding.coding.decode(code.permute(0, 2, 3, 1).numpy())[0]
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=2e-3)


def test_stopped_and_started_again_it_is_the_same_to_the_last_bit(pack, tmp_path):
    training, validation = halves(pack)
    whole = train_lighting(TINY, training, validation, tmp_path / "whole")
    calls = []

    class StopError(Exception):
        pass

    class Stopping(dict):
        def __getitem__(self, name):
            calls.append(name)
            if len(calls) > 12:  # in the second epoch
                raise StopError
            return super().__getitem__(name)

    broken = replace(training, arrays=Stopping(training.arrays))
    with pytest.raises(StopError):
        train_lighting(TINY, broken, validation, tmp_path / "parts")
    rest = train_lighting(TINY, training, validation, tmp_path / "parts")
    for one, other in zip(whole.parameters(), rest.parameters(), strict=True):
        assert torch.equal(one, other)
    histories = [
        [json.loads(x)["loss"] for x in (tmp_path / n / "history.jsonl").read_text().splitlines()]
        for n in ("whole", "parts")
    ]
    assert histories[0] == histories[1]


def with_tail(epochs):
    schedule = TINY.schedule.model_copy(update={"epochs": 2, "tail_epochs": epochs})
    return TINY.model_copy(update={"schedule": schedule})


def lines_of(work):
    return [json.loads(line) for line in (work / "history.jsonl").read_text().splitlines()]


@pytest.mark.parametrize("converged_after, epochs", [(1, 2), (4, 4), (99, 6)])
def test_it_goes_on_until_it_has_converged(pack, tmp_path, monkeypatch, converged_after, epochs):
    monkeypatch.setattr(loop, "has_converged", lambda losses: len(losses) >= converged_after)
    train_lighting(with_tail(4), *halves(pack), tmp_path)
    rates = [line["learning_rate"] for line in lines_of(tmp_path)]
    assert len(rates) == epochs
    assert rates[1] == pytest.approx(0, abs=1e-9)
    assert rates[2:] == pytest.approx([0.05 * TINY.schedule.learning_rate] * (epochs - 2))


def test_a_longer_tail_goes_on_from_a_shorter_one(pack, tmp_path, monkeypatch):
    monkeypatch.setattr(loop, "has_converged", lambda losses: False)
    whole = train_lighting(with_tail(3), *halves(pack), tmp_path / "whole")
    train_lighting(with_tail(0), *halves(pack), tmp_path / "parts")
    train_lighting(with_tail(1), *halves(pack), tmp_path / "parts")
    rest = train_lighting(with_tail(3), *halves(pack), tmp_path / "parts")
    for one, other in zip(whole.parameters(), rest.parameters(), strict=True):
        assert torch.equal(one, other)
    losses = [[line["loss"] for line in lines_of(tmp_path / n)] for n in ("whole", "parts")]
    assert len(losses[0]) == 5
    assert losses[0] == losses[1]


def test_mirrored_pairs_change_sides(pack):
    plain = TINY
    swapped = TINY.model_copy(
        update={"schedule": TINY.schedule.model_copy(update={"swap_views": True})}
    )
    picked = np.arange(12)
    (one, truth), (other, mirrored) = (batch_of(r, pack, picked, 5) for r in (plain, swapped))
    changed = [n for n in picked if not torch.equal(one["left"][n], other["left"][n])]
    assert 0 < len(changed) < 12
    n = changed[0]
    assert torch.equal(other["left"][n], one["right"][n].flip(-1))
    assert torch.equal(mirrored[n], truth[n].flip(-1))


def test_the_truth_has_no_loss_and_light_from_elsewhere_has(pack):
    recipe = LossRecipe(render=1, energy=1, direction=1)
    coding = TINY.coding.coding
    loss = MapLoss(recipe, coding)
    truth = torch.from_numpy(np.array(pack.arrays["env64"][:2])).permute(0, 3, 1, 2)
    code = torch.from_numpy(coding.encode(truth.permute(0, 2, 3, 1).numpy())).permute(0, 3, 1, 2)
    assert all(float(term) < 2e-3 for term in loss(code, truth).values())
    turned = loss(code.roll(16, dims=-1), truth)
    assert float(turned["render"]) > 0.05
    assert float(turned["direction"]) > 0.05
    assert float(turned["energy"]) < 2e-3


def test_the_render_loss_has_a_gradient_toward_the_truth(pack):
    truth = torch.from_numpy(np.array(pack.arrays["env64"][:1])).permute(0, 3, 1, 2)
    guess = torch.full_like(truth, float(truth.mean())).requires_grad_(True)
    optimizer = torch.optim.Adam([guess], lr=0.05)
    first = last = 0.0
    for step in range(40):
        optimizer.zero_grad()
        loss = render_difference(guess, truth)
        loss.backward()
        optimizer.step()
        last = float(loss.detach())
        first = last if step == 0 else first
    assert last < 0.6 * first


@pytest.mark.parametrize(
    "losses, expected",
    [([1.0] * 10, True), ([1 / n for n in range(1, 11)], False), ([1.0], False),
     ([5, 4, 3, 2, 1, 1, 1, 1, 1.2, 0.995], True)],
)  # fmt: skip
def test_convergence_is_told_by_the_last_fifth(losses, expected):
    assert has_converged(losses) is expected

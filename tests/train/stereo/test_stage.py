"""A suite from a dataset on disk to models: once, in one process or several, stopped or not."""

import hashlib
import json
import os
import signal
from multiprocessing import parent_process
from pathlib import Path

import numpy as np
import onnx
import pytest

torch = pytest.importorskip("torch")

from panokit.dataset.storage.index import indexed_digest  # noqa: E402
from panokit.engine import LocalEngine, SerialEngine  # noqa: E402
from panokit.errors import ModelError, Rejection, StorageError, UsageError  # noqa: E402
from panokit.evaluate.lighting.models import read_facts  # noqa: E402
from panokit.train.run import Run  # noqa: E402
from panokit.train.stereo import stage  # noqa: E402
from panokit.train.stereo.pack import open_pack  # noqa: E402
from panokit.train.stereo.sizes import at_size  # noqa: E402
from panokit.train.stereo.stage import (  # noqa: E402
    Training,
    plan_suite,
    train_model,
    train_one,
    train_suite,
    train_together,
)
from panokit.train.team import ALONE  # noqa: E402

pytestmark = pytest.mark.train
TINY = """
seeds = 2
samples = 12

[network]
input_px = 16
width = 4

[schedule]
epochs = 2
batch = 4
learning_rate = 3e-3
"""


def only_digest(recipe, network, folder):
    """In place of a release, which takes seconds of each training: a digest of all weights."""
    folder.mkdir(parents=True, exist_ok=True)
    weights = b"".join(one.numpy().tobytes() for one in network.state_dict().values())
    (folder / "model.toml").write_text(hashlib.sha256(weights).hexdigest())


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr(stage, "release_lighting", only_digest)


@pytest.fixture
def suite(tmp_path):
    """Two recipes in a folder, and a size."""
    folder = tmp_path / "recipes"
    folder.mkdir()
    (folder / "one.toml").write_text('id = "one"\ntask = "lighting"\n')
    (folder / "two.toml").write_text('id = "two"\ntask = "lighting"\nkind = "dematerial"\n')
    size = tmp_path / "tiny.toml"
    size.write_text(TINY)
    return folder, str(size)


def planned(suite, dataset, tmp_path, place="run"):
    folder, size = suite
    work = tmp_path / place
    return plan_suite([folder], size, dataset, work, work / "models")


def written(folder: Path) -> dict[str, bytes]:
    """What must be the same whenever a model is trained again; clocks are in training.json."""
    found = {p.name: p.read_bytes() for p in folder.iterdir() if p.name != stage.SUMMARY}
    record = json.loads((folder / stage.SUMMARY).read_text())
    del record["cpu_hours"]
    return found | {stage.SUMMARY: json.dumps(record).encode()}


def test_a_plan_has_all_recipes_with_each_seed(suite, small_dataset, tmp_path):
    plan = planned(suite, small_dataset, tmp_path)
    assert [training.recipe.id for training in plan] == [
        "one-tiny-s0", "two-tiny-s0", "one-tiny-s1", "two-tiny-s1",
    ]  # fmt: skip
    assert [training.experiment for training in plan] == ["one", "two", "one", "two"]
    assert plan[0].folder == tmp_path / "run" / "models" / "one-tiny-s0"


def test_a_plan_without_recipes_or_with_one_name_twice_is_refused(suite, small_dataset, tmp_path):
    folder, size = suite
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(UsageError, match="no recipes in"):
        plan_suite([empty], size, small_dataset, tmp_path, tmp_path)
    twice = tmp_path / "uno.toml"
    twice.write_text((folder / "one.toml").read_text())
    with pytest.raises(UsageError, match="2 recipes are called 'one'"):
        plan_suite([folder, twice], size, small_dataset, tmp_path, tmp_path)
    again = plan_suite([folder, folder / "one.toml"], size, small_dataset, tmp_path, tmp_path)
    assert len(again) == 4


def train_quickly(training: Training):
    """As `train_one`, in a worker."""
    stage.release_lighting = only_digest
    return train_one(training)


@pytest.mark.usefixtures("quick")
def test_processes_train_what_one_alone_does_and_nothing_twice(
    suite, small_dataset, tmp_path, monkeypatch
):
    torch.set_num_threads(1)  # as workers have
    alone = planned(suite, small_dataset, tmp_path, "alone")
    first = train_suite(alone, SerialEngine())
    assert [receipt.item for receipt in first] == [one.recipe.id for one in alone]
    together = planned(suite, small_dataset, tmp_path, "together")
    with monkeypatch.context() as patch:
        patch.setattr(stage, "train_one", train_quickly)
        found = train_suite(together, LocalEngine(2))
    assert sorted(receipt.item for receipt in found) == sorted(one.recipe.id for one in alone)
    assert all(receipt.fresh for receipt in (*first, *found))
    for one, other in zip(alone, together, strict=True):
        assert written(one.folder) == written(other.folder)
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.*")}
    again = train_suite(alone, SerialEngine())
    assert [receipt.fresh for receipt in again] == [False] * 4
    assert before == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.*")}


def test_a_model_is_what_the_evaluator_looks_for(suite, small_dataset, tmp_path):
    training = planned(suite, small_dataset, tmp_path)[2]
    train_one(training)
    facts = read_facts(training.folder)
    assert (facts.name, facts.experiment, facts.seed) == ("one-tiny-s1", "one", 1)
    assert (facts.samples, facts.steps, len(facts.history)) == (12, 6, 2)
    network = onnx.load(training.folder / "lighting.onnx")
    held = sum(int(np.prod(one.dims)) for one in network.graph.initializer)
    assert held == pytest.approx(facts.parameters, rel=0.3)


@pytest.mark.usefixtures("quick")
def test_the_summary_says_what_the_training_was(suite, small_dataset, tmp_path):
    training = planned(suite, small_dataset, tmp_path)[3]
    train_one(training)
    record = json.loads((training.folder / "training.json").read_text())
    assert record["schema"] == "panokit.lighting-training/1"
    assert (record["experiment"], record["kind"], record["seed"]) == ("two", "dematerial", 1)
    assert record["recipe"] == training.recipe.digest
    assert record["dataset"] == indexed_digest(small_dataset) != ""
    assert (record["samples"], record["steps"], record["epochs"]) == (12, 6, 2)
    assert record["input_px"] == 16
    assert record["places"] == sorted(set(record["places"]))
    assert all(place.startswith("place ") for place in record["places"])
    assert [line["step"] for line in record["history"]] == [3, 6]
    assert all(line["validation"] > 0 and line["ssd"] > 0 for line in record["history"])
    assert record["converged"] in (True, False)
    assert 0 < record["cpu_hours"] < 1


@pytest.mark.usefixtures("quick")
def test_another_recipe_or_dataset_is_trained_anew(suite, small_dataset, tmp_path, monkeypatch):
    training = planned(suite, small_dataset, tmp_path)[0]
    train_one(training)
    assert not train_one(training).fresh
    monkeypatch.setattr(stage, "indexed_digest", lambda _: "of another dataset")
    assert train_one(training).fresh
    assert not train_one(training).fresh
    longer = Path(suite[1])
    longer.write_text(TINY.replace("epochs = 2", "epochs = 1"))
    assert train_one(planned(suite, small_dataset, tmp_path)[0]).fresh


def killed_once(training: Training):
    """Train in a worker that is killed after the first epoch, the first time."""
    assert parent_process() is not None
    stage.release_lighting = only_digest
    mark = training.work / "was-killed"
    if not mark.exists():
        training.work.mkdir(parents=True, exist_ok=True)
        mark.touch()
        save = Run.save

        def last(run, path):
            save(run, path)
            os.kill(os.getpid(), signal.SIGKILL)

        Run.save = last
    return train_one(training)


@pytest.mark.usefixtures("quick")
def test_a_killed_training_goes_on_bit_by_bit(suite, small_dataset, tmp_path):
    torch.set_num_threads(1)
    whole = planned(suite, small_dataset, tmp_path, "whole")[0]
    train_one(whole)
    broken = planned(suite, small_dataset, tmp_path, "broken")[0]
    (outcome,) = LocalEngine(1).run(killed_once, [broken])
    assert outcome.fresh
    assert (broken.work / "was-killed").exists()
    assert written(whole.folder) == written(broken.folder)


@pytest.mark.usefixtures("quick")
def test_a_network_that_diverges_does_not_end_the_suite(
    suite, small_dataset, tmp_path, monkeypatch
):
    plan = planned(suite, small_dataset, tmp_path)[:2]
    original = stage.train_lighting

    def diverges(recipe, *arguments, **others):
        if recipe.id.startswith("one"):
            raise ModelError("Training diverged.")
        return original(recipe, *arguments, **others)

    monkeypatch.setattr(stage, "train_lighting", diverges)
    bad, good = train_suite(plan, SerialEngine())
    assert isinstance(bad, Rejection)
    assert (bad.item, bad.message) == ("one-tiny-s0", "Training diverged.")
    assert not plan[0].folder.exists()
    assert good.fresh


@pytest.mark.usefixtures("quick")
def test_sources_that_are_not_there_cost_their_own_networks_only(suite, small_dataset, tmp_path):
    (suite[0] / "more.toml").write_text(
        'id = "more"\ntask = "lighting"\n[[sources]]\ndata = "../elsewhere"\n'
    )
    plan = [one for one in planned(suite, small_dataset, tmp_path) if one.experiment != "two"][:2]
    done, missing = train_suite(plan, SerialEngine())
    assert (done.item, missing.item) == ("one-tiny-s0", "more-tiny-s0")
    assert missing.reason == "no-samples"
    assert "elsewhere" in missing.message
    with pytest.raises(StorageError, match="nowhere"):
        train_suite(planned(suite, tmp_path / "nowhere", tmp_path), SerialEngine())


@pytest.mark.usefixtures("quick")
def test_samples_come_from_the_sources_that_a_recipe_names(suite, small_dataset, tmp_path):
    places = open_pack(small_dataset, "train", 16, tmp_path / "run").places
    chosen = sorted(set(places))[:2]
    (suite[0] / "one.toml").write_text(
        'id = "one"\ntask = "lighting"\n[schedule]\nbatch = 2\n'
        f"[[sources]]\nplaces = {json.dumps(chosen)}\n[[sources]]\nsamples = 3\n"
    )
    training = planned(suite, small_dataset, tmp_path)[0]
    assert train_one(training).fresh
    record = json.loads((training.folder / "training.json").read_text())
    assert record["samples"] == np.isin(places, chosen).sum() + 3
    assert record["places"] == sorted({*chosen, *places[:3].tolist()})


@pytest.mark.usefixtures("quick")
def test_a_team_trains_one_after_the_other_and_skips_what_is_done(suite, small_dataset, tmp_path):
    plan = planned(suite, small_dataset, tmp_path)[:2]
    train_one(plan[0])
    assert [receipt.fresh for receipt in train_together(plan, ALONE)] == [False, True]


@pytest.mark.usefixtures("quick")
def test_a_single_model_needs_no_suite(suite, small_dataset, tmp_path):
    recipe = at_size(suite[0] / "one.toml", suite[1], 4)
    train_model(recipe, small_dataset, tmp_path, tmp_path / "model")
    assert json.loads((tmp_path / "model" / "training.json").read_text())["seed"] == 4
    assert (tmp_path / "model" / "model.toml").is_file()

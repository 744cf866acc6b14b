"""A model for each fold: what each has seen is written beside it, and what is done is kept."""

import json
from pathlib import Path

import numpy as np
import pytest

from panokit.cli.main import main
from panokit.evaluate import model_method, onnx_method
from panokit.evaluate.probe_set import assign_folds, find_probes

pytestmark = pytest.mark.train
pytest.importorskip("torch")

RECIPE = """
id = "tiny"
data = {shots_per_probe = 1}
network = {members = 2, steps = 2, batch = 2}
components = {members = 2, steps = 2, batch = 4}
"""
EXPANDNET = """
architecture = "expandnet"
id = "tinynet"
folds = 2
shots_per_probe = 1
steps = 1
batch = 1
crop_px = 32
smallest_crop_px = 32
largest_crop_px = 48
"""


@pytest.fixture(autouse=True)
def _two_small_folds(monkeypatch: pytest.MonkeyPatch):
    from panokit.evaluate import probe_set
    from panokit.train import examples, folds

    monkeypatch.setattr(probe_set, "PROBE_WIDTH_PX", 256)
    monkeypatch.setattr(folds, "FOLDS", 2)
    monkeypatch.setattr(examples, "FOLDS", 2)


def train(folder: Path, name: str, text: str, probes: Path, *options: str) -> int:
    recipe = folder / name
    recipe.write_text(text, encoding="utf-8")
    arguments = ["train", str(recipe), "--probes", str(probes), "--work", str(folder / "work")]
    return main([*arguments, "--processes", "1", "--folds", *options])


def test_each_fold_has_a_model_that_has_not_seen_it(probe_folder, tmp_path, capsys):
    assert train(tmp_path, "recipe.toml", RECIPE, probe_folder, "--fold-members", "1") == 0
    pattern = str(tmp_path / "work/tiny/fold-{fold}")
    assert pattern in capsys.readouterr().out.replace("\n", "")
    probes = find_probes(probe_folder)
    folds = assign_folds(probes, 2)
    method = model_method(pattern)
    assert method.name == "tiny (per fold)"
    for fold in (0, 1):
        seen = [bool(method.predictor(fold).has_seen(probe)) for probe in probes]
        assert seen == (folds != fold).tolist()
    assert method.predictor(0).digest != method.predictor(1).digest
    assert not (tmp_path / "model.toml").exists()


def test_what_is_done_is_kept_and_another_recipe_is_trained_anew(
    probe_folder, tmp_path, monkeypatch
):
    from panokit.train import folds

    released = []
    monkeypatch.setattr(folds, "release", lambda recipe, network, folder: released.append(folder))
    assert train(tmp_path, "recipe.toml", RECIPE, probe_folder, "--fold-members", "1") == 0
    assert [folder.name for folder in released] == ["fold-0", "fold-1"]
    record = tmp_path / "work/tiny/fold-1/training.json"
    record.unlink()
    assert train(tmp_path, "recipe.toml", RECIPE, probe_folder, "--fold-members", "1") == 0
    assert [folder.name for folder in released[2:]] == ["fold-1"]
    first = json.loads(record.read_text(encoding="utf-8"))["recipe_digest"]
    assert train(tmp_path, "recipe.toml", RECIPE, probe_folder) == 0
    assert len(released) == 5
    assert json.loads(record.read_text(encoding="utf-8"))["recipe_digest"] != first


def test_expandnet_has_folds_too(probe_folder, tmp_path):
    assert train(tmp_path, "any-name.toml", EXPANDNET, probe_folder) == 0
    method = onnx_method(tmp_path / "work/tinynet/fold-{fold}/expandnet.onnx")
    assert method.name == "expandnet (per fold)"
    probes = find_probes(probe_folder)
    for fold in (0, 1):
        seen = [method.predictor(fold).has_seen(probe) for probe in probes]
        assert np.array_equal(seen, assign_folds(probes, 2) != fold)
    paths = sorted((tmp_path / "work/tinynet").glob("*/expandnet.onnx"))
    times = [path.stat().st_mtime_ns for path in paths]
    assert train(tmp_path, "any-name.toml", EXPANDNET, probe_folder) == 0
    assert [path.stat().st_mtime_ns for path in paths] == times


def test_what_has_no_ensemble_has_no_members(probe_folder, tmp_path, capsys):
    options = ("--fold-members", "1")
    assert train(tmp_path, "any-name.toml", EXPANDNET, probe_folder, *options) == 2
    assert "--fold-members goes with" in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "work").exists()

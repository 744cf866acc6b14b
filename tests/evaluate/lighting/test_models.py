"""What a model's folder says, and which folders are models."""

import json

import pytest

from panokit.errors import ModelError
from panokit.evaluate.lighting.models import find_models, read_facts

CARD = """\
id = "{name}"
task = "lighting"

[lighting]
kind = "{kind}"
input_px = 64
views = "object"
materials = 1
coding = {{ brightest = 1000.0, color = "lab" }}

[files.lighting]
name = "lighting.onnx"
sha256 = "00ff"
"""


def model(place, name, kind="stereo", **training):
    folder = place / name
    folder.mkdir(parents=True)
    (folder / "model.toml").write_text(CARD.format(name=name, kind=kind))
    if training:
        (folder / "training.json").write_text(json.dumps(training))
    return folder


@pytest.mark.parametrize(
    "name, experiment, size, seed",
    [
        ("dot-product-deep-two-core-s1", "dot-product-deep", "two-core", 1),
        ("dematerial-3-full-s0", "dematerial-3", "full", 0),
        ("mine", "mine", "", 0),
        ("dense-reflectance-noise-20-pocket-s2", "dense-reflectance-noise-20", "pocket", 2),
    ],
)
def test_a_name_says_experiment_size_and_seed(tmp_path, name, experiment, size, seed):
    facts = read_facts(model(tmp_path, name))
    assert (facts.experiment, facts.size, facts.seed) == (experiment, size, seed)
    assert facts.converged is None
    assert facts.seen(["a"]) is None


def test_training_json_says_it_better(tmp_path):
    folder = model(
        tmp_path, "x-s4", experiment="dot-product", size="full", seed=2, converged=False,
        cpu_hours=1.5, places=["a", "b"], history=[{"step": 1, "ssd": 3.0}],
    )  # fmt: skip
    facts = read_facts(folder)
    assert (facts.experiment, facts.size, facts.seed) == ("dot-product", "full", 2)
    assert facts.converged is False
    assert facts.cpu_hours == 1.5
    assert facts.seen(["b", "c"]) == ["b"]
    assert len(facts.history) == 1


def test_noise_of_normals_is_known_from_the_name(tmp_path):
    noisy = read_facts(model(tmp_path, "dematerial-noise-20-two-core-s0", kind="dematerial"))
    assert (noisy.noise_deg, noisy.smooth_px) == (20, 4)
    assert read_facts(model(tmp_path, "dematerial-two-core-s0")).noise_deg == 0


def test_a_folder_of_models_is_all_of_them(tmp_path):
    for name in ("b-s0", "a-s0"):
        model(tmp_path, name)
    (tmp_path / "work").mkdir()
    assert [facts.name for facts in find_models([str(tmp_path)])] == ["a-s0", "b-s0"]
    assert len(find_models([str(tmp_path), str(tmp_path / "a-s0")])) == 2


def test_what_is_no_model_is_named(tmp_path):
    with pytest.raises(ModelError, match=r"holds no model.*panokit train"):
        find_models([str(tmp_path)])
    with pytest.raises(ModelError, match=r"no folder .*missing.*no released model"):
        find_models([str(tmp_path / "missing")])
    folder = model(tmp_path, "broken")
    (folder / "model.toml").write_text('id = "broken"\ntask = "lighting"\n')
    with pytest.raises(ModelError, match="tables \\[lighting\\]"):
        find_models([str(folder)])


def test_two_models_of_one_name_are_refused(tmp_path):
    one, other = model(tmp_path / "one", "same"), model(tmp_path / "other", "same")
    with pytest.raises(ModelError, match="both call their model 'same'"):
        find_models([str(one), str(other)])

"""A whole evaluation of a small dataset: files, resume, what is refused; speed and size."""

import json
from contextlib import suppress

import numpy as np
import pytest

from panokit.console import Console
from panokit.dataset import ProductionSettings, render_dataset
from panokit.dataset.storage.read import StereoDataset
from panokit.errors import ModelError, PanokitError, RecordError
from panokit.evaluate.lighting.evaluation import evaluate, read_lines
from panokit.evaluate.lighting.kept import Kept
from panokit.evaluate.lighting.models import read_facts
from panokit.evaluate.lighting.settings import LightingEvaluation
from panokit.evaluate.lighting.speed import count_operations, measure_speed
from panokit.evaluate.lighting.terminal import table_of
from tests.dataset.fake import FakeMaker
from tests.evaluate.lighting.made_up import lines_of
from tests.lighting.fakes import write_model

SETTINGS = LightingEvaluation(count=2, controls=1, protocol=("array",), protocol_count=1, keep=1,
                              training_maps=5)  # fmt: skip


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    out = tmp_path_factory.mktemp("data") / "stereo"
    render_dataset(FakeMaker(), out, ProductionSettings(count=40, workers=0))
    return out


@pytest.fixture
def model(tmp_path):
    """Adds half of each view."""
    pytest.importorskip("onnx")
    folder = write_model(tmp_path / "models" / "sum-s0", (0.5, 0.5))
    training = {"places": ["elsewhere"], "converged": True, "history": [{"ssd": 3.0, "step": 1}]}
    (folder / "training.json").write_text(json.dumps(training))
    return folder


def run(model, data, out, **options):
    return evaluate([str(model)], data, out, settings=SETTINGS, with_speed=False, **options)


@pytest.mark.train
def test_all_that_figures_need_is_written(model, data, tmp_path):
    out = tmp_path / "out"
    found = run(model, data, out)
    lines = lines_of(out / "results.jsonl")
    plain = [line for line in lines if not line["control"]]
    assert {line["predictor"] for line in plain} == {
        "sum", "mean map", "random map", "nearest map (oracle)", "background, extended",
        "ambient color", "least squares (true normals)",
    }  # fmt: skip
    assert len(plain) == 14
    assert {line["control"] for line in lines if line["control"]} == {
        "right is left", "exchanged", "right shifted", "right of another",
    }  # fmt: skip
    assert sum("array-rmse-fixed" in line["scores"] for line in plain) == 7
    assert lines_of(out / "history.jsonl")[0]["ssd"] == 3.0
    assert lines_of(out / "models.jsonl")[0]["seen"] == []
    splits = json.loads((out / "dataset.json").read_text())["splits"]
    assert sum(split["samples"] for split in splits.values()) == 40
    kept = Kept(out)
    assert len(kept.sample_keys()) == 1
    maps = [dict(kept.predictions(line["digest"])) for line in plain[:7]]
    assert all(len(one) == 1 for one in maps)
    first = [next(iter(one.values())) for one in maps]
    # The random map may be the nearest one.
    assert len({one.tobytes() for one in first}) >= 6
    assert max(len("  ".join(row)) for row in table_of(found)[0].rows) < 80


@pytest.mark.train
def test_what_was_scored_is_not_scored_again(model, data, tmp_path):
    out = tmp_path / "out"
    run(model, data, out, with_baselines=False)
    before = (out / "results.jsonl").read_bytes()
    run(model, data, out, with_baselines=False)
    assert (out / "results.jsonl").read_bytes() == before
    card = (model / "model.toml").read_text()
    (model / "model.toml").write_text(card.replace("0" * 64, "1" * 64))
    run(model, data, out, with_baselines=False)
    digests = {line["digest"] for line in lines_of(out / "results.jsonl")}
    assert digests == {"1" * 64}


@pytest.mark.train
def test_models_that_saw_the_test_are_marked(model, data, tmp_path):
    places = json.loads((model / "training.json").read_text())
    splits = run(model, data, tmp_path / "out").seen
    assert splits == {"sum": []}
    (model / "training.json").write_text(
        json.dumps(places | {"places": ["test-place-0", "test-place-1"]})
    )
    found = run(model, data, tmp_path / "out")
    assert found.seen["sum"]
    row = next(row for row in table_of(found)[0].rows if row[0].startswith("sum"))
    assert row[0].endswith("*")


@pytest.mark.train
def test_one_broken_model_of_many_is_left_out(model, data, tmp_path):
    broken = write_model(tmp_path / "models" / "broken", (1.0, 0.0))
    text = (broken / "model.toml").read_text()
    (broken / "model.toml").write_text(text.replace('"sum"', '"broken"'))
    (broken / "lighting.onnx").unlink()
    found = run(tmp_path / "models", data, tmp_path / "out", with_baselines=False)
    assert [facts.name for facts in found.models] == ["sum"]
    with pytest.raises(ModelError, match=r"no .*lighting.onnx"):
        run(broken, data, tmp_path / "out")


@pytest.mark.train
@pytest.mark.parametrize("more_px", [0, 1])
def test_pictures_that_are_enlarged_are_told_of(model, data, tmp_path, capsys, more_px):
    width_px = StereoDataset(data, "test", members=("left.png",))[0]["left"].shape[1]
    card = (model / "model.toml").read_text()
    there = f"input_px = {read_facts(model).input_px}"
    (model / "model.toml").write_text(card.replace(there, f"input_px = {width_px + more_px}"))
    with suppress(PanokitError):  # the network itself wants what it wants
        run(model, data, tmp_path / "out", with_baselines=False, console=Console())
    assert ("are enlarged" in capsys.readouterr().err) is bool(more_px)


def test_a_damaged_record_says_what_to_do(tmp_path):
    (tmp_path / "models.jsonl").write_text("{")
    with pytest.raises(RecordError, match="Delete it"):
        read_lines(tmp_path / "models.jsonl")


@pytest.mark.train
def test_operations_and_parameters_are_counted(tmp_path):
    onnx = pytest.importorskip("onnx")
    helper, kind = onnx.helper, onnx.TensorProto.FLOAT
    weights = helper.make_tensor("w", kind, [4, 3, 3, 3], np.ones(108).tolist())
    node = helper.make_node("Conv", ["x", "w"], ["y"], pads=[1, 1, 1, 1])
    graph = helper.make_graph(
        [node], "conv", [helper.make_tensor_value_info("x", kind, [1, 3, 8, 8])],
        [helper.make_tensor_value_info("y", kind, [1, 4, 8, 8])], [weights],
    )  # fmt: skip
    path = tmp_path / "conv.onnx"
    onnx.save(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9),
              path)  # fmt: skip
    operations, parameters = count_operations(path, {"x": np.ones((1, 3, 8, 8), np.float32)})
    assert operations == 2 * 4 * 8 * 8 * 3 * 9
    assert parameters == 108


@pytest.mark.train
def test_speed_is_measured_in_a_process_of_its_own(model):
    found = measure_speed(read_facts(model), device="cpu")
    assert 0 < found.p50_ms <= found.p95_ms
    assert found.fps == pytest.approx(1000 / found.p50_ms, rel=0.05)
    assert found.memory_mb >= 0
    assert "ONNX Runtime" in found.hardware

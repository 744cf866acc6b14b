import sys
from pathlib import Path

import numpy as np
import pytest

from panokit.color import srgb_decode_u8
from panokit.errors import ItemError, ModelError, UsageError
from panokit.evaluate.peers import command_method, method_of, onnx_method, peer_method
from panokit.evaluate.probe_set import ListedProbe

PICTURE = np.random.default_rng(0).integers(0, 255, (32, 64, 3), dtype=np.uint8)
PROBE = ListedProbe(name="p", path=Path("p"), category="c", group="g", sha256="ab")

SCRIPT = """
import sys
from pathlib import Path
from panokit.color import srgb_decode_u8
from panokit.io import read_panorama, write_environment_map
from panokit.envmap import EnvironmentMap
source, target = map(Path, sys.argv[-2:])
radiance = srgb_decode_u8(read_panorama(source).pixels)
write_environment_map(EnvironmentMap(radiance=radiance), target)
"""


def onnx_file(path: Path, shape: list, scale: float = 2.0) -> Path:
    """A network that multiplies its picture by a number."""
    onnx = pytest.importorskip("onnx")
    helper, kind = onnx.helper, onnx.TensorProto.FLOAT
    graph = helper.make_graph(
        [helper.make_node("Mul", ["picture", "scale"], ["light"])],
        "g",
        [helper.make_tensor_value_info("picture", kind, shape)],
        [helper.make_tensor_value_info("light", kind, shape)],
        [helper.make_tensor("scale", kind, [], [scale])],
    )
    opset = [helper.make_opsetid("", 17)]
    onnx.save(helper.make_model(graph, opset_imports=opset, ir_version=9), path)
    return path


@pytest.mark.train
@pytest.mark.parametrize(
    "shape", [[1, 3, "h", "w"], [1, "h", "w", 3], [1, 3, 32, 64]], ids=["nchw", "nhwc", "fixed"]
)
def test_any_onnx_of_a_picture_is_a_peer(tmp_path: Path, shape: list):
    method = onnx_method(onnx_file(tmp_path / "double.onnx", shape))
    assert method.name == "double"
    predictor = method.predictor(3)
    light = predictor.predict(PICTURE)
    assert light == pytest.approx(2 * PICTURE.astype(np.float32) / 255, abs=1e-5)
    assert predictor.has_seen(PROBE) is None


@pytest.mark.train
def test_a_peer_may_have_a_network_for_each_fold(tmp_path: Path):
    for fold in (0, 1):
        folder = tmp_path / f"fold-{fold}"
        folder.mkdir()
        onnx_file(folder / "net.onnx", [1, 3, "h", "w"], 2.0 + fold)
    method = onnx_method(tmp_path / "fold-{fold}" / "net.onnx")
    assert method.name == "net (per fold)"
    first, second = (method.predictor(fold) for fold in (0, 1))
    assert first.digest != second.digest
    assert second.predict(PICTURE) == pytest.approx(1.5 * first.predict(PICTURE), rel=1e-5)


@pytest.mark.train
def test_a_network_of_fixed_size_gets_the_picture_at_its_size(tmp_path: Path):
    method = onnx_method(onnx_file(tmp_path / "small.onnx", [1, 3, 16, 32], 1.0))
    light = method.predictor(0).predict(PICTURE)
    assert light.shape == PICTURE.shape
    assert light.mean() == pytest.approx(PICTURE.mean() / 255, rel=0.05)


@pytest.mark.train
def test_a_peer_says_by_its_training_record_what_it_saw(tmp_path: Path):
    path = onnx_file(tmp_path / "net.onnx", [1, 3, "h", "w"])
    (tmp_path / "training.json").write_text('{"seen": {"p": "ab"}}', encoding="utf-8")
    predictor = onnx_method(path).predictor(0)
    assert predictor.has_seen(PROBE) is True
    other = ListedProbe(name="q", path=Path("q"), category="c", group="g", sha256="cd")
    assert predictor.has_seen(other) is False
    (tmp_path / "training.json").write_text("[]", encoding="utf-8")
    with pytest.raises(ModelError, match="does not say"):
        onnx_method(path)


@pytest.mark.train
def test_a_network_that_takes_no_picture_is_refused(tmp_path: Path):
    with pytest.raises(ModelError, match="RGB picture"):
        onnx_method(onnx_file(tmp_path / "odd.onnx", [1, 16, 64, 128]))
    (tmp_path / "text.onnx").write_text("no network", encoding="utf-8")
    with pytest.raises(ModelError, match="can load"):
        onnx_method(tmp_path / "text.onnx")


def test_any_command_is_a_peer(tmp_path: Path):
    script = tmp_path / "peer.py"
    script.write_text(SCRIPT, encoding="utf-8")
    method = command_method(f"mine={sys.executable} {script} {{input}} {{output}}", 60)
    assert method.name == "mine"
    light = method.predictor(0).predict(PICTURE)
    assert light == pytest.approx(srgb_decode_u8(PICTURE), rel=1e-5)
    # Without places for them, the two paths come last.
    plain = command_method(f"{sys.executable} {script}", 60)
    assert plain.name.startswith("python")
    assert np.array_equal(plain.predictor(0).predict(PICTURE), light)


@pytest.mark.train
def test_a_peer_is_told_by_its_ending(tmp_path: Path):
    path = onnx_file(tmp_path / "net.onnx", [1, 3, "h", "w"])
    assert peer_method(str(path), 5).name == "net"
    assert method_of(str(path)).name == "net"
    assert peer_method("net2=onnx-runner --fast", 5).name == "net2"


def test_the_released_baseline_is_judged_by_its_id():
    method = method_of("expandnet")
    assert method.name == "expandnet"
    light = method.predictor(0).predict(PICTURE)
    assert light.shape == PICTURE.shape
    assert 0 <= light.min() < light.max() <= 1
    assert method.predictor(0).has_seen(PROBE) is False
    assert method_of("expand-1").name == "expand-1"


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("raise SystemExit('no more film')", "command-failed"),
        ("pass", "no-output"),
        ("import time; time.sleep(30)", "timeout"),
    ],
)
def test_a_command_that_fails_costs_one_picture(code: str, reason: str):
    method = command_method(f'x={sys.executable} -c "{code}"', 60 if reason != "timeout" else 1)
    with pytest.raises(ItemError) as caught:
        method.predictor(0).predict(PICTURE)
    assert caught.value.reason == reason
    if reason == "command-failed":
        assert "no more film" in str(caught.value)


def test_a_command_that_is_none_is_refused():
    with pytest.raises(UsageError, match="Cannot run"):
        command_method("x=/no/such/program", 5).predictor(0).predict(PICTURE)
    with pytest.raises(UsageError, match="NAME=PROGRAM"):
        command_method("x=", 5)
    with pytest.raises(UsageError, match="command line"):
        command_method("x='unclosed", 5)

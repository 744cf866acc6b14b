import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from panokit.errors import ModelError
from panokit.expand.settings import ExpandSettings
from panokit.inference import CPU, CUDA, Session, providers_for
from panokit.weights import find_model


@pytest.fixture(scope="module")
def components() -> Session:
    return Session(find_model("expand-1").path("components"), threads=1)


def test_a_network_runs_by_the_names_of_its_inputs(components: Session):
    assert components.inputs == ("features",)
    assert components.outputs == ("log_gain",)
    result = components.run({"features": np.zeros((1, 3, 60), np.float32)})
    assert result["log_gain"].shape == (1, 3)


def test_wrong_names_and_shapes_are_model_errors(components: Session):
    with pytest.raises(ModelError, match="takes \\['features'\\]"):
        components.run({"rows": np.zeros((1, 3, 60), np.float32)})
    with pytest.raises(ModelError, match="input shapes"):
        components.run({"features": np.zeros((1, 3, 7), np.float32)})


def test_a_result_that_is_not_finite_is_an_error(components: Session):
    with pytest.raises(ModelError, match="not finite"):
        components.run({"features": np.full((1, 3, 60), np.nan, np.float32)})


def test_a_file_that_is_no_network_is_a_model_error(tmp_path: Path):
    path = tmp_path / "broken.onnx"
    path.write_bytes(b"not a network")
    with pytest.raises(ModelError, match="can load"):
        Session(path)


@pytest.mark.parametrize(
    ("device", "available", "expected"),
    [
        ("auto", [CPU], [CPU]),
        ("auto", [CUDA, CPU], [CUDA, CPU]),
        ("auto", ["TensorrtExecutionProvider", CUDA, CPU], [CUDA, CPU]),
        ("cuda", [CUDA, CPU], [CUDA, CPU]),
        ("cpu", [CUDA, CPU], [CPU]),
    ],
)
def test_a_gpu_is_taken_where_there_is_one_and_it_is_wanted(device, available, expected):
    providers = providers_for(device, available)
    assert [name for name, _ in providers] == expected
    # Ten bits of mantissa would be no parity.
    assert all(options == {"use_tf32": "0"} for name, options in providers if name == CUDA)


def test_a_gpu_that_is_not_there_and_an_unknown_device_are_model_errors():
    with pytest.raises(ModelError, match="onnxruntime-gpu"):
        providers_for("cuda", [CPU])
    with pytest.raises(ModelError, match="auto, cpu or cuda"):
        providers_for("tpu", [CPU])


def test_a_session_asks_for_what_was_chosen_and_says_what_it_got(monkeypatch: pytest.MonkeyPatch):
    asked = []

    class Runtime:
        """As ONNX Runtime with CUDA behaves: what it cannot start it leaves out."""

        def __init__(self, path, options, providers):
            asked.append([name for name, _ in providers])

        def get_providers(self):
            return [name for name in asked[-1] if name != CUDA or has_driver]

    monkeypatch.setattr("onnxruntime.get_available_providers", lambda: [CUDA, CPU])
    monkeypatch.setattr("onnxruntime.InferenceSession", Runtime)
    has_driver = True
    assert Session(Path("x.onnx")).device == "cuda"
    assert Session(Path("x.onnx"), device="cpu").device == "cpu"
    has_driver = False
    assert Session(Path("x.onnx")).device == "cpu"
    with pytest.raises(ModelError, match="nvidia-smi"):
        Session(Path("x.onnx"), device="cuda")
    assert asked == [[CUDA, CPU], [CPU], [CUDA, CPU], [CUDA, CPU]]


def test_where_a_map_is_computed_does_not_change_its_key():
    assert ExpandSettings(device="cpu").digest == ExpandSettings().digest
    assert ExpandSettings(device="cpu").device == "cpu"


def test_nothing_is_reported_to_anybody(tmp_path):
    # ONNX Runtime's telemetry would leave a device id and a queue of events at home.
    environment = {k: v for k, v in os.environ.items() if k != "ORT_DISABLE_TELEMETRY"}
    code = "import panokit.inference"
    subprocess.run(
        [sys.executable, "-c", code], check=True, env=environment | {"HOME": str(tmp_path)}
    )
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


@pytest.mark.parametrize(("said", "expected"), [("", 2), ("1", 1), ("8,2", 2), ("0", 1)])
def test_a_network_computes_with_no_more_threads_than_its_process_may(
    monkeypatch: pytest.MonkeyPatch, said: str, expected: int
):
    monkeypatch.setenv("OMP_NUM_THREADS", said)
    session = Session(find_model("expand-1").folder / "components.onnx", threads=2)
    assert session._session.get_session_options().intra_op_num_threads == expected

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from panokit.errors import ModelError
from panokit.inference import Session
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


def test_nothing_is_reported_to_anybody(tmp_path):
    # ONNX Runtime's telemetry would leave a device id and a queue of events at home.
    environment = {k: v for k, v in os.environ.items() if k != "ORT_DISABLE_TELEMETRY"}
    code = "import panokit.inference"
    subprocess.run(
        [sys.executable, "-c", code], check=True, env=environment | {"HOME": str(tmp_path)}
    )
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]

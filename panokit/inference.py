"""Networks in use: ONNX Runtime sessions, on a GPU or the CPU, with the results checked.

The only module that imports onnxruntime.
"""

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Some builds of ONNX Runtime report their use to their maker; panokit sends nothing anywhere.
os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")

import onnxruntime

from panokit.errors import ModelError

DEFAULT_THREADS = 2
CPU, CUDA = "CPUExecutionProvider", "CUDAExecutionProvider"


def providers_for(device: str, available: Sequence[str]) -> list[tuple[str, dict[str, str]]]:
    """What ONNX Runtime is asked to run on, in order, for a device by name.

    The CPU is always the last resort: an operation that a GPU lacks runs there.

    Args:
        device: "auto" takes an NVIDIA GPU if there is one, "cuda" insists on it, "cpu" does not
            look for one.
        available: Providers that this build of ONNX Runtime has.

    Returns:
        (provider, its options) each.

    Raises:
        ModelError: If the device is not known, or not there.
    """
    if device not in ("auto", "cpu", "cuda"):
        raise ModelError(f"There is no device {device!r}. Choose auto, cpu or cuda.")
    if device == "cuda" and CUDA not in available:
        raise ModelError(
            "This ONNX Runtime has no CUDA. Install onnxruntime-gpu in place of onnxruntime, or "
            "use --device cpu."
        )
    # Without TF32, which keeps ten bits, a GPU gives what the CPU gives.
    gpu = [(CUDA, {"use_tf32": "0"})] if device != "cpu" and CUDA in available else []
    return [*gpu, (CPU, {})]


def available_providers() -> list[str]:
    """The providers of this build of ONNX Runtime; that of CUDA may still lack its libraries."""
    return list(onnxruntime.get_available_providers())


def runtime_version() -> str:
    """Of ONNX Runtime."""
    return str(onnxruntime.__version__)


class Session:
    """One network, ready to run; safe to use from several threads.

    Args:
        path: Of the .onnx file.
        threads: For one run, at most as many as OMP_NUM_THREADS says, which is one in the workers
            of an engine. The result does not depend on it beyond rounding.
        device: "auto", "cpu" or "cuda", see `providers_for`.

    Raises:
        ModelError: If the file is no network, or the device cannot be had.
    """

    def __init__(self, path: Path, *, threads: int = DEFAULT_THREADS, device: str = "auto") -> None:
        providers = providers_for(device, available_providers())
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = _most_threads(threads)
        options.inter_op_num_threads = 1
        options.log_severity_level = 3
        try:
            self._session = onnxruntime.InferenceSession(str(path), options, providers=providers)
        except Exception as error:  # onnxruntime raises a class of its own per failure
            raise ModelError(
                f"{path} is not a network that ONNX Runtime {onnxruntime.__version__} can load: "
                f"{str(error).splitlines()[0]} Get the file again."
            ) from error
        self._path = path
        if device == "cuda" and self.device != "cuda":
            raise ModelError(
                "ONNX Runtime has CUDA but cannot start it: a library or the driver is missing. "
                "Check `nvidia-smi` and the versions that onnxruntime-gpu asks for, or use "
                "--device cpu."
            )

    @property
    def device(self) -> str:
        """Where the network runs: "cuda" or "cpu"."""
        return "cuda" if CUDA in self._session.get_providers() else "cpu"

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, in order."""
        return tuple(value.name for value in self._session.get_inputs())

    @property
    def input_shapes(self) -> tuple[tuple[int | None, ...], ...]:
        """Shapes of the inputs, in order; None where a length is free."""
        return tuple(
            tuple(length if isinstance(length, int) else None for length in value.shape)
            for value in self._session.get_inputs()
        )

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs, in order."""
        return tuple(value.name for value in self._session.get_outputs())

    def run(self, inputs: Mapping[str, NDArray[np.float32]]) -> dict[str, NDArray[np.float32]]:
        """Run the network.

        Args:
            inputs: Name -> float32 array.

        Returns:
            Name -> float32 array, all finite.

        Raises:
            ModelError: If a name or shape is wrong, or a result is not finite.
        """
        if set(inputs) != set(self.inputs):
            raise ModelError(
                f"{self._path.name} takes {list(self.inputs)}, not {sorted(inputs)}. The model "
                "and this version of panokit do not belong together."
            )
        arrays: dict[str, Any] = {
            name: np.ascontiguousarray(value, np.float32) for name, value in inputs.items()
        }
        try:
            results = self._session.run(None, arrays)
        except Exception as error:  # onnxruntime raises a class of its own per failure
            raise ModelError(
                f"{self._path.name} failed: {str(error).splitlines()[0]} Its input shapes were "
                f"{ {name: value.shape for name, value in arrays.items()} }."
            ) from error
        for name, result in zip(self.outputs, results, strict=True):
            if not np.isfinite(result).all():
                raise ModelError(
                    f"{self._path.name} gave a result {name!r} that is not finite. Check the "
                    "input for NaN, and the file with: panokit models verify"
                )
        return dict(zip(self.outputs, results, strict=True))


def _most_threads(threads: int) -> int:
    """So many threads, or as few as OMP_NUM_THREADS allows, where ONNX Runtime does not look."""
    allowed = os.environ.get("OMP_NUM_THREADS", "").partition(",")[0].strip()
    return min(threads, max(1, int(allowed))) if allowed.isdigit() else threads


def profile_nodes(path: Path, inputs: Mapping[str, NDArray[np.float32]]) -> list[dict[str, Any]]:
    """What ONNX Runtime tells of each node of a network in one run on the CPU.

    Args:
        path: Of the .onnx file.
        inputs: Name -> float32 array.

    Returns:
        A record for each node: "op_name", "input_type_shape", "output_type_shape" and
        "parameter_size", the bytes of its constants. Nodes are as written, not fused.
    """
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 3
    options.enable_profiling = True
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_DISABLE_ALL
    with tempfile.TemporaryDirectory() as folder:
        options.profile_file_prefix = str(Path(folder) / "profile")
        session = onnxruntime.InferenceSession(str(path), options, providers=[CPU])
        session.run(None, dict(inputs))
        events = json.loads(Path(session.end_profiling()).read_text(encoding="utf-8"))
    told = [event["args"] for event in events if event["name"].endswith("_kernel_time")]
    return [record for record in told if "output_type_shape" in record]

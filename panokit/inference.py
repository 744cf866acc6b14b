"""Networks in use: ONNX Runtime sessions, on the CPU, with the results checked.

The only module that imports onnxruntime.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Some builds of ONNX Runtime report their use to their maker; panokit sends nothing anywhere.
os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")

import onnxruntime

from panokit.errors import ModelError

DEFAULT_THREADS = 2


class Session:
    """One network, ready to run; safe to use from several threads.

    Args:
        path: Of the .onnx file.
        threads: For one run. The result does not depend on it beyond rounding.
    """

    def __init__(self, path: Path, *, threads: int = DEFAULT_THREADS) -> None:
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        options.inter_op_num_threads = 1
        options.log_severity_level = 3
        try:
            self._session = onnxruntime.InferenceSession(
                str(path), options, providers=["CPUExecutionProvider"]
            )
        except Exception as error:  # onnxruntime raises a class of its own per failure
            raise ModelError(
                f"{path} is not a network that ONNX Runtime {onnxruntime.__version__} can load: "
                f"{str(error).splitlines()[0]} Get the file again."
            ) from error
        self._path = path

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

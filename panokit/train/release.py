"""From trained networks to the files of a released model."""

import hashlib
import json
import logging
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from panokit.errors import ModelError
from panokit.expand.component_features import COMPONENT_FEATURES
from panokit.expand.features import CHANNELS, GRID_HEIGHT_PX, GRID_WIDTH_PX
from panokit.expand.network import FEATURES_VERSION
from panokit.inference import Session
from panokit.io.files import atomic_write, write_bytes
from panokit.networks.expansion_net import ExpansionNet
from panokit.train.onnx_file import without_traces
from panokit.train.recipe import Recipe

# The largest difference between torch and ONNX Runtime, relative to the largest value.
PARITY = 1e-5

_FILE = "expansion.onnx"
# How model.toml describes what goes in and comes out: shape, and what it means.
INPUTS = {
    "grid": (
        [1, len(CHANNELS), GRID_HEIGHT_PX, GRID_WIDTH_PX],
        "panokit.expand.features.grid_features",
    ),
    "features": (
        [1, "count", COMPONENT_FEATURES],
        "panokit.expand.component_features, one row of zeros where nothing is burnt out",
    ),
}
OUTPUTS = {
    "log_gain": (
        [3, GRID_HEIGHT_PX, GRID_WIDTH_PX],
        "log of the true over the shown radiance of burnt-out pixels, per channel",
    ),
    "slopes": ([2], "of the camera's response, in the dark and at white"),
    "component_gain": (["count"], "log of the true over the shown luminance of each component"),
    "sun_logit": (["count"], "log odds that the component is the sun"),
    "grid_weight": ([], "how much the grid counts in the log of a component's energy, constant"),
}


def release(recipe: Recipe, network: ExpansionNet, folder: Path) -> None:
    """Write the network and `model.toml`, which comes last.

    Raises:
        ModelError: If ONNX Runtime does not give what torch gives.
    """
    folder.mkdir(parents=True, exist_ok=True)
    example = {
        "grid": torch.rand(1, len(CHANNELS), GRID_HEIGHT_PX, GRID_WIDTH_PX),
        "features": torch.rand(1, 5, COMPONENT_FEATURES),
    }
    count = torch.export.Dim("count")
    export(network, example, tuple(OUTPUTS), {1: count}, folder / _FILE, only="features")
    write_bytes(folder / "model.toml", _description(recipe, folder).encode())


def export(
    network: nn.Module,
    example: Mapping[str, Tensor],
    outputs: tuple[str, ...],
    dynamic: Mapping[int, Any],
    path: Path,
    *,
    only: str = "",
    parity: float = PARITY,
) -> None:
    """Write one network as ONNX and check that it computes the same.

    Args:
        network: Taking tensors, in the order of `example`.
        example: Name -> example input.
        outputs: Their names, in order.
        dynamic: Axis -> dimension, of every input.
        path: Of the .onnx file.
        only: The one input that has these dimensions, if not every one has.
        parity: The largest difference that is admitted, relative to the largest value.

    Raises:
        ModelError: If ONNX Runtime does not give what torch gives.
    """
    network = network.eval()
    with warnings.catch_warnings(), _quiet_exporter():
        # The exporter warns of its own internals; the parity check below is what counts.
        warnings.simplefilter("ignore")
        program = torch.onnx.export(
            network,
            tuple(example.values()),
            input_names=list(example),
            output_names=list(outputs),
            dynamic_shapes=tuple(
                {} if only not in ("", name) else dict(dynamic) for name in example
            ),
            dynamo=True,
            external_data=False,
            verbose=False,
        )
    if program is None:
        raise ModelError(f"torch could not export {path.name}.")
    with atomic_write(path) as temporary:
        temporary.write_bytes(without_traces(program.model_proto).SerializeToString())
    with torch.inference_mode():
        expected = network(*example.values())
    expected = expected if isinstance(expected, tuple) else (expected,)
    found = Session(path).run({name: value.numpy() for name, value in example.items()})
    for name, value in zip(outputs, expected, strict=True):
        _check_parity(path.name, name, found[name], value.numpy(), parity)


def _check_parity(
    file: str,
    output: str,
    found: NDArray[np.float32],
    expected: NDArray[np.float32],
    parity: float,
) -> None:
    difference = float(np.abs(found - expected).max()) / max(float(np.abs(expected).max()), 1e-6)
    if difference > parity:
        raise ModelError(
            f"{file}: {output} differs between torch and ONNX Runtime by {difference:.1e} of its "
            f"largest value, more than {parity:.0e}. Export with another version of torch."
        )


def _description(recipe: Recipe, folder: Path) -> str:
    sha256 = hashlib.sha256((folder / _FILE).read_bytes()).hexdigest()
    lines = [
        f'id = "{recipe.id}"',
        f'task = "{recipe.task}"',
        'license = "CC0-1.0"',
        'description = "Light beyond clipping from one LDR panorama"',
        f'features_version = "{FEATURES_VERSION}"',
        "",
        "[files.expansion]",
        f'name = "{_FILE}"',
        f'sha256 = "{sha256}"',
        f"inputs = {json.dumps(list(INPUTS))}",
        f"outputs = {json.dumps(list(OUTPUTS))}",
    ]
    for name, (shape, meaning) in (INPUTS | OUTPUTS).items():
        lines += [
            "",
            f"[tensors.{name}]",
            'type = "float32"',
            f"shape = {json.dumps(shape)}",
            f'meaning = "{meaning}"',
        ]
    return "\n".join(lines) + "\n"


class _quiet_exporter:  # noqa: N801
    """Keeps the exporter's remarks about packages that it does not need out of the log."""

    def __enter__(self) -> None:
        self._logger = logging.getLogger("torch.onnx")
        self._level = self._logger.level
        self._logger.setLevel(logging.ERROR)

    def __exit__(self, *_: object) -> None:
        self._logger.setLevel(self._level)

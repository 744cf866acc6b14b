"""From a trained lighting network to the files of a model: pictures in, radiance out."""

import hashlib
import json
from pathlib import Path

import torch
from torch import Tensor, nn

from panokit.errors import ModelError
from panokit.inference import Session
from panokit.io.files import write_bytes
from panokit.networks.stereo.coding import decode
from panokit.train.release import export
from panokit.train.stereo.pack import REFLECTANCE_PX
from panokit.train.stereo.recipe import LightingRecipe

FILE = "lighting.onnx"
# Of the largest value. The exponential that makes radiance of code enlarges rounding errors: ten
# times what networks without one are allowed.
PARITY = 1e-4
_MEANINGS = {
    "left": "the left view, display-encoded in [0, 1]",
    "right": "the right view, display-encoded in [0, 1]",
    "background": "what is behind the object in the left view, display-encoded in [0, 1]",
    "maps": "sparse reflectance maps of the materials: three colors and validity each",
    "map": "a sparse reflectance map: three colors and validity",
    "radiance": "linear radiance, 1.0 is the white of the pictures",
}


class Released(nn.Module):
    """A network between pictures in [0, 1] and radiance.

    Args:
        network: Trained.
        recipe: By which it was trained.
    """

    def __init__(self, network: nn.Module, recipe: LightingRecipe) -> None:
        super().__init__()
        self.network = network
        self.coding = recipe.coding.coding

    def forward(
        self, first: Tensor, second: Tensor | None = None, third: Tensor | None = None
    ) -> Tensor:
        """Inputs in the order of `inputs_of`, as many as there are, to radiance (B, 3, 64, 64)."""
        pictures = [one for one in (first, second, third) if one is not None]
        code = self.network(*(2 * picture - 1 for picture in pictures))
        return decode(code, self.coding)


def inputs_of(recipe: LightingRecipe) -> dict[str, tuple[int, int]]:
    """Name -> channels and width of each input, in order."""
    size = recipe.network.input_px
    if recipe.kind == "stereo":
        return {"left": (3, size), "right": (3, size), "background": (3, size)}
    if recipe.kind == "dematerial":
        return {"maps": (4 * recipe.materials, REFLECTANCE_PX), "background": (3, size)}
    if recipe.kind == "dense-reflectance":
        return {"map": (4, REFLECTANCE_PX)}
    return {"left": (3, size)}


def release_lighting(recipe: LightingRecipe, network: nn.Module, folder: Path) -> None:
    """Write the network and `model.toml`, which comes last.

    Raises:
        ModelError: If ONNX Runtime does not give what torch gives, or takes one batch size alone.
    """
    folder.mkdir(parents=True, exist_ok=True)
    example = {
        name: torch.rand(2, channels, size)[..., None].expand(2, channels, size, size).clone()
        for name, (channels, size) in inputs_of(recipe).items()
    }
    batch = torch.export.Dim("batch", min=1, max=4096)
    released = Released(network, recipe)
    export(released, example, ("radiance",), {0: batch}, folder / FILE, parity=PARITY)
    shapes = Session(folder / FILE, device="cpu").input_shapes
    if any(shape[0] is not None for shape in shapes):
        raise ModelError(f"{FILE} takes one batch size alone: {shapes}. Mend the network.")
    write_bytes(folder / "model.toml", _description(recipe, folder).encode())


def _noise(recipe: LightingRecipe) -> list[str]:
    """With which normals it is to be judged: as far off as those that it learned from."""
    if recipe.normals.noise_deg == 0:
        return []
    return [f"noise_deg = {recipe.normals.noise_deg}", f"smooth_px = {recipe.normals.smooth_px}"]


def _description(recipe: LightingRecipe, folder: Path) -> str:
    sha256 = hashlib.sha256((folder / FILE).read_bytes()).hexdigest()
    inputs = inputs_of(recipe)
    views = "composited" if recipe.network.background == "composited" else "object"
    lines = [
        f'id = "{recipe.id}"',
        'task = "lighting"',
        'license = "CC0-1.0"',
        'description = "The light of a scene from two views of an unknown object"',
        'features_version = "1"',
        "",
        "[lighting]",
        f'kind = "{recipe.kind}"',
        f"input_px = {recipe.network.input_px}",
        f'views = "{views}"',
        f"materials = {recipe.materials}",
        f'coding = {{ brightest = {recipe.coding.brightest}, color = "{recipe.coding.color}" }}',
        *_noise(recipe),
        "",
        "[files.lighting]",
        f'name = "{FILE}"',
        f'sha256 = "{sha256}"',
        f"inputs = {json.dumps(list(inputs))}",
        'outputs = ["radiance"]',
    ]
    shapes = {
        **{name: ["batch", channels, size, size] for name, (channels, size) in inputs.items()},
        "radiance": ["batch", 3, 64, 64],
    }
    for name, shape in shapes.items():
        lines += [
            "",
            f"[tensors.{name}]",
            'type = "float32"',
            f"shape = {json.dumps(shape)}",
            f'meaning = "{_MEANINGS[name]}"',
        ]
    return "\n".join(lines) + "\n"

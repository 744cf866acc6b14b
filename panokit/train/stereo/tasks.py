"""What each kind of network is given in training, and what it is to give."""

from collections.abc import Callable, Mapping

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from panokit.networks.stereo.net import StereoNet
from panokit.networks.stereo.reflectance import Dematerial, PictureToMap
from panokit.networks.stereo.sparse import sparse_reflectance
from panokit.reflectance.normals import add_noise
from panokit.train.stereo.pack import REFLECTANCE_PX, Pack
from panokit.train.stereo.recipe import LightingRecipe

Indices = NDArray[np.int64]


def build_network(recipe: LightingRecipe) -> nn.Module:
    """A network of the recipe's kind, with fresh weights."""
    size, width, layers = (
        recipe.network.input_px, recipe.network.width, recipe.network.layers,
    )  # fmt: skip
    if recipe.kind == "stereo":
        return StereoNet(recipe.network, recipe.coding.coding)
    if recipe.kind == "dematerial":
        return Dematerial(
            materials=recipe.materials, background_px=size, width=width, layers=layers
        )
    if recipe.kind == "dense-reflectance":
        return PictureToMap(4, input_px=REFLECTANCE_PX, width=width, layers=layers)
    return PictureToMap(3, input_px=size, width=width, layers=layers)


def batch_of(
    recipe: LightingRecipe, pack: Pack, picked: Indices, seed: int
) -> tuple[dict[str, Tensor], Tensor]:
    """The inputs by name, and the target as radiance (B, 3, 64, 64).

    Args:
        recipe: Which kind of network.
        pack: The split.
        picked: Numbers of samples.
        seed: For what is random about the inputs.
    """
    inputs = _INPUTS[recipe.kind](recipe, pack, picked, seed)
    to_light = recipe.kind in ("stereo", "dematerial")
    truth = _radiance(pack, "env64" if to_light else "reflectance", picked)
    if recipe.schedule.swap_views and recipe.kind == "stereo":
        _swap(inputs, truth, np.random.default_rng([seed, 1]).random(len(picked)) < 0.5)
    return inputs, truth


def _stereo(recipe: LightingRecipe, pack: Pack, picked: Indices, seed: int) -> dict[str, Tensor]:
    of_object = "" if recipe.network.background == "composited" else "_object"
    return {
        "left": _picture(pack, f"left{of_object}", picked),
        "right": _picture(pack, f"right{of_object}", picked),
        "background": _picture(pack, "background", picked),
    }


def _dematerial(
    recipe: LightingRecipe, pack: Pack, picked: Indices, seed: int
) -> dict[str, Tensor]:
    part = np.asarray(pack.arrays["part"][picked])
    # With one map all materials go into it, as if the object had one.
    maps = [
        _sparse(recipe, pack, picked, part > 0 if recipe.materials == 1 else part == n + 1, seed)
        for n in range(recipe.materials)
    ]
    return {"maps": torch.cat(maps, dim=1), "background": _picture(pack, "background", picked)}


def _dense(recipe: LightingRecipe, pack: Pack, picked: Indices, seed: int) -> dict[str, Tensor]:
    part = np.asarray(pack.arrays["part"][picked])
    return {"map": _sparse(recipe, pack, picked, part == 1, seed)}


def _from_picture(
    recipe: LightingRecipe, pack: Pack, picked: Indices, seed: int
) -> dict[str, Tensor]:
    return {"left": _picture(pack, "left_object", picked)}


_INPUTS: Mapping[str, Callable[[LightingRecipe, Pack, Indices, int], dict[str, Tensor]]] = {
    "stereo": _stereo,
    "dematerial": _dematerial,
    "dense-reflectance": _dense,
    "picture-reflectance": _from_picture,
}


def _picture(pack: Pack, name: str, picked: Indices) -> Tensor:
    """Pictures as (B, 3, S, S) in [0, 1]."""
    pixels = torch.from_numpy(np.ascontiguousarray(pack.arrays[name][picked]))
    return pixels.permute(0, 3, 1, 2).float() / 255


def _radiance(pack: Pack, name: str, picked: Indices) -> Tensor:
    values = torch.from_numpy(np.ascontiguousarray(pack.arrays[name][picked], np.float32))
    return values.permute(0, 3, 1, 2).contiguous()


def _sparse(
    recipe: LightingRecipe, pack: Pack, picked: Indices, mask: NDArray[np.bool_], seed: int
) -> Tensor:
    """Sparse reflectance maps with their validity, (B, 4, 64, 64)."""
    normals = np.asarray(pack.arrays["normal"][picked], np.float32)
    mask = mask & (np.abs(normals).sum(axis=-1) > 0)
    if recipe.normals.noise_deg > 0:
        normals = np.stack(
            [
                add_noise(
                    one, seen, recipe.normals.noise_deg, smooth_px=recipe.normals.smooth_px,
                    seed=seed + int(number),
                )
                for one, seen, number in zip(normals, mask, picked, strict=True)
            ]
        )  # fmt: skip
    colors, hits = sparse_reflectance(
        _picture(pack, "left_object", picked),
        torch.from_numpy(normals).permute(0, 3, 1, 2),
        torch.from_numpy(mask),
        width_px=REFLECTANCE_PX,
    )
    return torch.cat([colors, (hits > 0).float()[:, None]], dim=1)


def _swap(inputs: dict[str, Tensor], truth: Tensor, which: NDArray[np.bool_]) -> None:
    """Mirror some pairs in place: what the right camera saw is then seen by the left one."""
    chosen = torch.from_numpy(np.flatnonzero(which))
    left, right = inputs["left"][chosen].flip(-1), inputs["right"][chosen].flip(-1)
    inputs["left"][chosen], inputs["right"][chosen] = right, left
    inputs["background"][chosen] = inputs["background"][chosen].flip(-1)
    truth[chosen] = truth[chosen].flip(-1)

"""What Cycles writes, as the passes of a view."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.scene import NO_DEPTH, Material, View, ViewPasses
from panokit.errors import PanokitError
from panokit.frames import TOOL_FROM_PANOKIT

Channels = dict[str, NDArray[np.float32]]
_LAYERS = {"Combined": "RGBA", "Normal": "XYZ", "Depth": "Z", "IndexMA": "X", "DiffCol": "RGB"}
# Depth of what no ray met is a very large number.
_NOWHERE_M = 1e6


def read_exr_channels(path: Path) -> Channels:
    """The layers of a multi-layer EXR that are wanted, (H, W, C) float32 each.

    Raises:
        PanokitError: If Blender did not write the file, or not as expected.
    """
    import OpenEXR

    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            found = {
                tuple(name.split(".")[-2:]): np.array(channel.pixels, np.float32)
                for part in file.parts
                for name, channel in part.channels.items()
            }
    except (OSError, RuntimeError) as error:
        raise PanokitError(f"Blender left no readable picture {path.name} ({error}).") from error
    layers = {}
    for layer, names in _LAYERS.items():
        if all((layer, name) in found for name in names):
            layers[layer] = np.stack([found[layer, name] for name in names], axis=-1)
    if "Combined" not in layers:
        raise PanokitError(f"Blender's picture {path.name} has no layer Combined.")
    return layers


def view_passes(
    beauty: Channels,
    guides: Channels,
    materials: tuple[Material, ...],
    view: View,
    shadow: NDArray[np.float32] | None,
) -> ViewPasses:
    """The passes of one view; normals come in Blender's world frame."""
    combined = beauty["Combined"]
    depth = guides["Depth"][..., 0]
    there = depth < _NOWHERE_M
    part = np.where(there, np.rint(guides["IndexMA"][..., 0]), 0).astype(np.uint8)
    in_world = guides["Normal"].astype(np.float64) @ TOOL_FROM_PANOKIT["blender"].matrix
    normal = view.world_from_camera.inverse.apply(in_world)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    return ViewPasses(
        radiance=np.ascontiguousarray(np.maximum(combined[..., :3], 0)),
        coverage=np.clip(combined[..., 3], 0, 1),
        part=part,
        normal=np.where(there[..., None], normal, 0).astype(np.float32),
        depth=np.where(there, depth, NO_DEPTH).astype(np.float32),
        albedo=_albedo(guides["DiffCol"], part, materials),
        shadow=shadow,
    )


def _albedo(
    diffuse: NDArray[np.float32], part: NDArray[np.uint8], materials: tuple[Material, ...]
) -> NDArray[np.float32]:
    """Base colors: what Cycles calls the diffuse color has the metal and the coat taken off it."""
    picture = np.zeros_like(diffuse)
    for index, material in enumerate(materials, start=1):
        mine = part == index
        if material.texture is None:
            picture[mine] = np.asarray(material.base_color, np.float32)
            continue
        scale = max(1 - material.metallic, 1e-3)
        picture[mine] = np.clip(diffuse[mine] / scale, 0, 1)
    return picture


def shadow_of(both: Channels, bare: Channels) -> NDArray[np.float32]:
    """By what the floor's light is multiplied because the object stands there."""
    with_object, without = both["Combined"][..., :3], bare["Combined"][..., :3]
    ratio: NDArray[Any] = np.ones_like(without)
    np.divide(with_object, without, out=ratio, where=without > 0)
    return np.clip(ratio, 0, 1).astype(np.float32)

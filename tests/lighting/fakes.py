"""Views of a striped box, and models that are simple enough to know what they should say."""

import json
from pathlib import Path

import numpy as np
import pytest

from panokit.frames import Rotation
from panokit.lighting.confidence import Confidence
from panokit.lighting.estimate import LightEstimate
from panokit.stereo import Views

SIZE = 64


def box_views(shift_px: int = 6, size: int = SIZE, seed: int = 0) -> Views:
    """A textured box that lies `shift_px` farther left in the right view."""
    rng = np.random.default_rng(seed)
    texture = rng.integers(60, 200, (size, size, 3)).astype(np.uint8)
    background = np.full((size, size, 3), 90, np.uint8)
    background[: size // 2] = 150
    mask = np.zeros((size, size), bool)
    mask[16:48, 22:50] = True
    other = np.roll(mask, -shift_px, axis=1)
    moved = np.roll(texture, -shift_px, axis=1)
    left_object = np.where(mask[..., None], texture, 0).astype(np.uint8)
    right_object = np.where(other[..., None], moved, 0).astype(np.uint8)
    return Views(
        left=np.where(mask[..., None], texture, background).astype(np.uint8),
        right=np.where(other[..., None], moved, background).astype(np.uint8),
        left_object=left_object,
        right_object=right_object,
        mask=mask,
        background=background,
        normals=np.zeros((size, size, 3), np.float32),
        parts=mask.astype(np.uint8),
        fov_deg=40.0,
        baseline_m=0.2,
        left_level=Rotation.from_heading_pitch_roll(0, -0.2, 0.05),
    )


def beacon(direction, level=0.2, peak=400.0) -> np.ndarray:
    """(64, 64, 3): one bright pixel where a direction lies, on an even ground."""
    radiance = np.full((64, 64, 3), level, np.float32)
    x, y, z = np.asarray(direction, float) / np.linalg.norm(direction)
    column = int((np.arctan2(x, -z) / (2 * np.pi) + 0.5) * 64) % 64
    row = min(int((0.5 - np.arcsin(y) / np.pi) * 64), 63)
    radiance[row, column] = [peak, 0.8 * peak, 0.5 * peak]
    return radiance


def estimate_of(radiance, error=0.3, level=None, **more) -> LightEstimate:
    confidence = None
    if error is not None:
        confidence = Confidence(
            error=np.full((64, 64), error, np.float32), direction_deg=5.0, calibrated=True
        )
    return LightEstimate(
        radiance=radiance, level_from_camera=level or Rotation.identity(), confidence=confidence,
        **more,
    )  # fmt: skip


class FakeNetwork:
    """Says of views what a function says; looks at both."""

    sees_both = True

    def __init__(self, answer):
        self.answer = answer

    def read(self, views):
        return self.answer(views)

    def read_all(self, several):
        return [self.answer(views) for views in several]


def write_model(folder: Path, weights=(1.0, 1.0), **spec) -> Path:
    """A model on disk: left and right pictures, weighted and added, are the light."""
    onnx = pytest.importorskip("onnx")
    helper, kind = onnx.helper, onnx.TensorProto.FLOAT
    shape = ["batch", 3, SIZE, SIZE]
    inputs = [helper.make_tensor_value_info(n, kind, shape) for n in ("left", "right")]
    scales = [helper.make_tensor(f"s{k}", kind, [], [w]) for k, w in enumerate(weights)]
    nodes = [
        helper.make_node("Mul", ["left", "s0"], ["a"]),
        helper.make_node("Mul", ["right", "s1"], ["b"]),
        helper.make_node("Add", ["a", "b"], ["radiance"]),
    ]
    output = helper.make_tensor_value_info("radiance", kind, shape)
    graph = helper.make_graph(nodes, "sum", inputs, [output], scales)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    folder.mkdir(parents=True, exist_ok=True)
    onnx.save(model, folder / "lighting.onnx")
    table = {"kind": "stereo", "input_px": SIZE, "views": "composited", "materials": 1} | spec
    lines = [
        'id = "sum"', f'task = "{table.pop("task", "lighting")}"', 'license = "CC0-1.0"',
        'description = "A sum"', 'features_version = "1"', "", "[lighting]",
        *(f"{name} = {json.dumps(value)}" for name, value in table.items()), "",
        "[files.lighting]", 'name = "lighting.onnx"', f'sha256 = "{"0" * 64}"',
        'inputs = ["left", "right"]', 'outputs = ["radiance"]', "",
    ]  # fmt: skip
    (folder / "model.toml").write_text("\n".join(lines))
    return folder

"""A maker of tiny samples without a renderer, for tests of what happens around them."""

import os
import signal
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from panokit.color.transfer import srgb_encode_u8
from panokit.dataset.sample import SCHEMA, Sample, sample_key
from panokit.dataset.settings import DatasetSettings
from panokit.dataset.splits import split_of_index
from panokit.dataset.storage.members import exr_bytes, json_bytes
from panokit.errors import ItemError, MissingExtraError
from panokit.io.images import encode_png

WIDTH_PX = 16
_SETTINGS = DatasetSettings(renderer="analytic")


@dataclass(frozen=True, slots=True, kw_only=True)
class FakeMaker:
    """Samples of noise; sample `index` misbehaves as `troubles` says.

    Attributes:
        settings: Only the seed and the shares matter.
        troubles: Index -> what its attempts do: "blank" (all are rejected), "blank-twice",
            "crash-once", "dies" (always), "dies-once" (needs `marks`), "hangs", "no-extra".
        seconds: How long each sample takes.
        marks: A folder for what must be known across processes.
    """

    settings: DatasetSettings = _SETTINGS
    troubles: Mapping[int, str] = ()
    seconds: float = 0.0
    marks: Path | None = None

    def describe(self) -> Mapping[str, Any]:
        return {
            "version": "1",
            "settings": self.settings.model_dump(mode="json"),
            "renderer": {"name": "fake", "version": "1"},
            "stock": "0" * 64,
        }

    def split_of(self, index: int) -> str:
        return split_of_index(self.settings, index)

    def seed_of(self, index: int, attempt: int) -> Sequence[int]:
        return [self.settings.seed, index, attempt]

    def make(self, index: int, attempt: int) -> Sample:
        time.sleep(self.seconds)
        self._misbehave(dict(self.troubles).get(index, ""), index, attempt)
        return fake_sample(self.settings.seed, index, attempt, self.split_of(index))

    def _misbehave(self, trouble: str, index: int, attempt: int) -> None:
        if trouble == "blank" or (trouble == "blank-twice" and attempt < 2):
            raise ItemError("The object covers nothing.", reason="blank-mask")
        if trouble == "crash-once" and attempt == 0:
            raise ZeroDivisionError("the renderer divided by zero")
        if trouble == "dies" or (trouble == "dies-once" and self._first_time(index)):
            os.kill(os.getpid(), signal.SIGKILL)
        if trouble == "hangs" and attempt == 0:
            time.sleep(300)
        if trouble == "no-extra":
            raise MissingExtraError("mitsuba", "render", "Rendering")

    def _first_time(self, index: int) -> bool:
        mark = self.marks / str(index)
        if mark.exists():
            return False
        mark.touch()
        return True


def fake_sample(seed: int, index: int, attempt: int, split: str) -> Sample:
    """A sample with the members and the record of a real one, 16 pixels wide."""
    rng = np.random.default_rng([seed, index, attempt])
    shape = (WIDTH_PX, WIDTH_PX)
    y, x = (np.mgrid[:WIDTH_PX, :WIDTH_PX] + 0.5) / WIDTH_PX * 2 - 1
    seen = x**2 + y**2 < 0.7
    normal = np.dstack([x, -y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))]) * seen[..., None]
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
    light = rng.gamma(0.3, 1.0, (8, 16, 3)).repeat(16, 0).repeat(16, 1).astype(np.float32)
    members: dict[str, bytes] = {}
    for side in ("left", "right"):
        color = rng.random(3) * np.maximum(normal @ [0.4, 0.6, 0.7], 0)[..., None]
        background = rng.random(3) * 0.3
        noise = rng.random((*shape, 3)) * 0.05
        members[f"{side}.png"] = encode_png(
            srgb_encode_u8(np.where(seen[..., None], color, background) + noise)
        )
        members[f"{side}_object.png"] = encode_png(srgb_encode_u8(color))
        members[f"{side}_mask.png"] = encode_png(seen.astype(np.uint8) * 255)
        members[f"{side}_normal.exr"] = exr_bytes(normal, half=True)
        members[f"{side}_depth.exr"] = exr_bytes((3 - normal[..., 2]) * seen, half=True)
    members["background.png"] = encode_png(srgb_encode_u8(np.broadcast_to(background, (*shape, 3))))
    members["env64.exr"] = exr_bytes(light.reshape(64, 2, 64, 4, 3).mean(axis=(1, 3)))
    members["env.exr"] = exr_bytes(light)
    members["reflectance.exr"] = exr_bytes(rng.random((64, 64, 3)))
    number = int(rng.integers(4))
    view = {"width_px": WIDTH_PX, "fov_deg": 40.0, "world_from_camera": np.eye(3).tolist()}
    meta = {
        "schema": SCHEMA,
        "key": sample_key(index),
        "index": index,
        "attempt": attempt,
        "split": split,
        "exposure": 1.0,
        "exposure_stops": float(rng.normal(0, 0.5)),
        "yaw_deg": float(rng.uniform(0, 360)),
        "baseline_m": 0.2,
        "materials": [{"roughness": float(rng.random()), "metallic": 0.0, "texture": False}],
        "object": {
            "id": f"{split}-chair-{number}",
            "license": "CC0-1.0",
            "attribution": "made by panokit",
            "details": {"kind": "chair"},
            "sha256": f"{split}{number}",
        },
        "probe": {
            "id": f"{split}-map-{number}",
            "place": f"{split}-place-{number // 2}",
            "kind": "native" if number else "lifted",
            "category": "indoor_lamps",
            "license": "CC-BY-4.0",
            "attribution": f"Photographer {number}",
            "sha256": f"{split}-map-{number}",
        },
        "views": {"left": view, "right": view},
        "renderer": {"name": "fake", "version": "1"},
        "samples": 1,
        "figures": {"mask_share": float(seen.mean())},
    }
    members["meta.json"] = json_bytes(meta)
    return Sample(
        key=sample_key(index), split=split, members=members, meta=meta, views=(), figures={}
    )

"""What predicts a map from two views: released models, any ONNX file, and the baselines."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ModelError
from panokit.evaluate.lighting.background import BackgroundExtrapolation
from panokit.evaluate.lighting.baselines import (
    AmbientColor,
    MeanMap,
    NearestMap,
    RandomMap,
    TrainingMaps,
)
from panokit.evaluate.lighting.inversion import ReflectanceInversion
from panokit.evaluate.lighting.sample import StereoSample, Views
from panokit.inference import Session
from panokit.reflectance import segment_materials, sparse_reflectance


class LightingPredictor(Protocol):
    """Predicts the light of a scene."""

    name: str

    def predict(self, sample: StereoSample) -> NDArray[np.float32]:
        """(64, 64, 3) linear radiance, anamorphic, in the left camera's frame, 1.0 white."""
        ...


def baselines(training: TrainingMaps) -> tuple[LightingPredictor, ...]:
    """The baselines of every comparison."""
    return (
        MeanMap(training),
        RandomMap(training),
        NearestMap(training),
        BackgroundExtrapolation(),
        AmbientColor(),
        ReflectanceInversion(),
    )


class NetworkPredictor:
    """A model that reads light, from its folder; see docs/formats.md for what goes in.

    Args:
        folder: With model.toml and the network that it names.
        name: For tables; the folder's name if not given.

    Raises:
        ModelError: If the folder holds no such model.
    """

    def __init__(self, folder: Path, name: str = "") -> None:
        self.name = name or folder.name
        try:
            card = tomllib.loads((folder / "model.toml").read_text(encoding="utf-8"))
            spec, file = card["lighting"], card["files"]["lighting"]["name"]
            self._size, self._views = int(spec["input_px"]), str(spec["views"])
            self._materials = int(spec.get("materials", 1))
        except (OSError, tomllib.TOMLDecodeError, KeyError, ValueError) as error:
            raise ModelError(
                f"{folder} is not a model that reads light from two views ({error!r}). "
                "Its model.toml needs the tables [lighting] and [files.lighting]."
            ) from error
        self.session = Session(folder / file)
        unknown = set(self.session.inputs) - {"left", "right", "background", "maps"}
        if unknown:
            raise ModelError(f"{folder} asks for {sorted(unknown)}, which samples do not have.")

    def predict(self, sample: StereoSample) -> NDArray[np.float32]:
        """(64, 64, 3)."""
        found = self.session.run(self.inputs(sample))
        radiance = np.asarray(next(iter(found.values())))[0]
        if radiance.shape != (3, 64, 64):
            raise ModelError(f"{self.name} gives {radiance.shape}, not (3, 64, 64).")
        return np.ascontiguousarray(np.maximum(radiance.transpose(1, 2, 0), 0))

    def inputs(self, sample: StereoSample) -> dict[str, NDArray[np.float32]]:
        """What the network is given: each of its inputs with a batch of one."""
        views = sample.views
        on_background = self._views == "composited"
        make: dict[str, Callable[[], NDArray[np.float32]]] = {
            "left": lambda: self._picture(views.left if on_background else views.left_object),
            "right": lambda: self._picture(views.right if on_background else views.right_object),
            "background": lambda: self._picture(views.background),
            "maps": lambda: self._maps(views),
        }
        return {name: make[name]() for name in self.session.inputs}

    def _picture(self, picture: NDArray[np.uint8]) -> NDArray[np.float32]:
        size = (self._size, self._size)
        if picture.shape[:2] != size:
            picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
        return np.ascontiguousarray(picture.transpose(2, 0, 1)[None] / np.float32(255))

    def _maps(self, views: Views) -> NDArray[np.float32]:
        """Sparse reflectance maps by the true normals, of as many materials as there are inputs."""
        picture = views.left_object / np.float32(255)
        seen = views.mask & (np.abs(views.normals).sum(axis=-1) > 0)
        masks = [seen]
        if self._materials > 1:
            part = segment_materials(picture, seen, self._materials)
            masks = [part == number for number in range(1, self._materials + 1)]
        channels = []
        for mask in masks:
            found = sparse_reflectance(picture, views.normals, mask)
            channels += [found.color.transpose(2, 0, 1), found.valid[None].astype(np.float32)]
        return np.concatenate(channels)[None]

"""What predicts a map from two views: released models, any ONNX file, and the baselines."""

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
from panokit.evaluate.lighting.models import ModelFacts, read_facts
from panokit.evaluate.lighting.sample import StereoSample, Views
from panokit.inference import Session
from panokit.reflectance import add_noise, sparse_reflectance

_INPUTS = frozenset({"left", "right", "background", "maps", "map"})


class LightingPredictor(Protocol):
    """Predicts the light of a scene.

    Attributes:
        name: For tables.
        digest: Changes when it predicts otherwise; what was scored under another is scored anew.
    """

    name: str
    digest: str

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
        model: Its folder, with model.toml and the network that it names; or what was read of it.
        name: For tables; the model's id if not given.

    Raises:
        ModelError: If the folder holds no such model.
    """

    def __init__(self, model: Path | ModelFacts, name: str = "") -> None:
        self.facts = read_facts(model) if isinstance(model, Path) else model
        self.name = name or self.facts.name
        self.digest = self.facts.digest
        path = self.facts.folder / self.facts.file
        if not path.is_file():
            raise ModelError(f"There is no {path}, which its model.toml names. Train it again.")
        self.session = Session(path)
        unknown = set(self.session.inputs) - _INPUTS
        if unknown:
            raise ModelError(f"{path} asks for {sorted(unknown)}, which samples do not have.")

    def predict(self, sample: StereoSample) -> NDArray[np.float32]:
        """(64, 64, 3): light, or for networks that predict reflectance a dense map of it."""
        found = self.session.run(self.inputs(sample))
        radiance = np.asarray(next(iter(found.values())))[0]
        if radiance.shape != (3, 64, 64):
            raise ModelError(f"{self.name} gives {radiance.shape}, not (3, 64, 64).")
        return np.ascontiguousarray(np.maximum(radiance.transpose(1, 2, 0), 0))

    def inputs(self, sample: StereoSample) -> dict[str, NDArray[np.float32]]:
        """What the network is given: each of its inputs with a batch of one."""
        views = sample.views
        # A network from a picture to reflectance sees no background either.
        on_background = self.facts.kind == "stereo" and self.facts.views == "composited"
        make: dict[str, Callable[[], NDArray[np.float32]]] = {
            "left": lambda: self._picture(views.left if on_background else views.left_object),
            "right": lambda: self._picture(views.right if on_background else views.right_object),
            "background": lambda: self._picture(views.background),
            "maps": lambda: self._maps(views, int(sample.key)),
            "map": lambda: self._maps(views, int(sample.key)),
        }
        return {name: make[name]() for name in self.session.inputs}

    def _picture(self, picture: NDArray[np.uint8]) -> NDArray[np.float32]:
        small = self._small(picture)
        return np.ascontiguousarray(small.transpose(2, 0, 1)[None] / np.float32(255))

    def _maps(self, views: Views, seed: int) -> NDArray[np.float32]:
        """Sparse reflectance maps by the true normals and materials, as in training."""
        picture = self._small(views.left_object) / np.float32(255)
        size = self.facts.input_px
        parts = cv2.resize(views.parts, (size, size), interpolation=cv2.INTER_NEAREST)
        normals = self._normals(views.normals)
        seen = (np.asarray(parts) > 0) & (np.abs(normals).sum(axis=-1) > 0)
        if self.facts.noise_deg > 0:
            normals = add_noise(
                normals, seen, self.facts.noise_deg, smooth_px=self.facts.smooth_px, seed=seed
            )
        if self.facts.kind == "dense-reflectance":
            masks = [seen & (parts == 1)]
        elif self.facts.materials == 1:
            masks = [seen]
        else:
            masks = [seen & (parts == number + 1) for number in range(self.facts.materials)]
        channels = []
        for mask in masks:
            found = sparse_reflectance(picture, normals, mask)
            channels += [found.color.transpose(2, 0, 1), found.valid[None].astype(np.float32)]
        return np.concatenate(channels)[None]

    def _small(self, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
        size = (self.facts.input_px, self.facts.input_px)
        if picture.shape[:2] == size:
            return picture
        return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)

    def _normals(self, normals: NDArray[np.float32]) -> NDArray[np.float32]:
        """Of larger pixels: means, made unit again."""
        size = (self.facts.input_px, self.facts.input_px)
        if normals.shape[:2] == size:
            return normals
        small = np.asarray(cv2.resize(normals, size, interpolation=cv2.INTER_AREA), np.float32)
        length = np.linalg.norm(small, axis=-1, keepdims=True)
        return np.where(length > 0.5, small / np.maximum(length, 1e-6), 0).astype(np.float32)

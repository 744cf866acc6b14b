"""What predicts a map from two views: released models, any ONNX file, and the baselines."""

import tomllib
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ModelError, UsageError
from panokit.evaluate.lighting.background import BackgroundExtrapolation
from panokit.evaluate.lighting.baselines import (
    AmbientColor,
    MeanMap,
    NearestMap,
    RandomMap,
    TrainingMaps,
)
from panokit.evaluate.lighting.inversion import ReflectanceInversion
from panokit.evaluate.lighting.sample import StereoSample
from panokit.inference import Session


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
    """A network from an ONNX file.

    Its inputs are `left`, `right` and `background`, (1, 3, S, S) float32, display-encoded in
    [0, 1], or those of them that it has; its output is (1, 3, 64, 64) linear radiance.

    Args:
        folder: A model's folder: model.onnx and model.toml with a table `lighting`: `input_px`,
            and `views`, which is "composited" or "object".
        name: For tables; the folder's name if not given.

    Raises:
        ModelError: If the folder holds no such model.
    """

    def __init__(self, folder: Path, name: str = "") -> None:
        self.name = name or folder.name
        try:
            card = tomllib.loads((folder / "model.toml").read_text(encoding="utf-8"))
            spec = card["lighting"]
            self._size, self._views = int(spec["input_px"]), str(spec["views"])
        except (OSError, tomllib.TOMLDecodeError, KeyError, ValueError) as error:
            raise ModelError(
                f"{folder} is not a model that reads light from two views ({error!r})."
            ) from error
        if self._views not in ("composited", "object"):
            raise ModelError(f'{folder}: views is "composited" or "object", not {self._views!r}.')
        self._session = Session(folder / "model.onnx")

    def predict(self, sample: StereoSample) -> NDArray[np.float32]:
        """(64, 64, 3)."""
        given = self.inputs(sample)
        found = self._session.run({name: given[name] for name in self._session.inputs})
        radiance = np.asarray(next(iter(found.values())))[0]
        if radiance.shape != (3, 64, 64):
            raise UsageError(f"{self.name} gives {radiance.shape}, not (3, 64, 64).")
        return np.maximum(radiance.transpose(1, 2, 0), 0)

    def inputs(self, sample: StereoSample) -> dict[str, NDArray[np.float32]]:
        """What the network is given."""
        views = sample.views
        composited = self._views == "composited"
        pictures = {
            "left": views.left if composited else views.left_object,
            "right": views.right if composited else views.right_object,
            "background": views.background,
        }
        return {name: self._prepared(picture) for name, picture in pictures.items()}

    def _prepared(self, picture: NDArray[np.uint8]) -> NDArray[np.float32]:
        size = (self._size, self._size)
        if picture.shape[:2] != size:
            picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
        return np.ascontiguousarray(picture.transpose(2, 0, 1)[None] / np.float32(255))

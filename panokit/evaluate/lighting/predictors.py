"""What predicts a map from two views: released models, any ONNX file, and the baselines."""

from functools import partial
from pathlib import Path
from typing import Protocol

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
from panokit.evaluate.lighting.sample import StereoSample
from panokit.reflectance import add_noise
from panokit.reflectance.light_network import LightNetwork, NormalNoise


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
        self.network = LightNetwork(self.facts.folder)
        batches = {shape[0] for shape in self.network.session.input_shapes}
        if not batches <= {1, None}:
            raise ModelError(
                f"{self.facts.folder} takes batches of {batches} alone, which is not how light is "
                "read. Release it again with a free batch."
            )

    def predict(self, sample: StereoSample) -> NDArray[np.float32]:
        """(64, 64, 3): light, or for networks that predict reflectance a dense map of it."""
        return self.network.read(sample.views, self._noise(int(sample.key)))

    def _noise(self, seed: int) -> NormalNoise | None:
        """What spoils the normals of a sample, if the model was trained with such."""
        if self.facts.noise_deg <= 0:
            return None
        return partial(
            add_noise, mean_deg=self.facts.noise_deg, smooth_px=self.facts.smooth_px, seed=seed
        )

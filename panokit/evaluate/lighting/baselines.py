"""Predictions that hardly look: what any method has to beat.

All figures of a comparison come with these, computed on the same samples. The mean map is the mean
of the logs of the training maps; the random map is one of them; the nearest map is the one of
them nearest to the *truth*, which no method can know: how far memory alone could get.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_decode_u8
from panokit.errors import UsageError
from panokit.evaluate.lighting.sample import StereoSample
from panokit.sphere.solid_angle import row_solid_angles

Maps = NDArray[np.float32]
MOST_MAPS = 4000
_DARKEST = 1e-3


class TrainingMaps:
    """The maps of a training split, (N, 64, 64, 3) float32.

    Args:
        maps: One for each sample; at most `MOST_MAPS` of them are kept, evenly over all.
    """

    def __init__(self, maps: Iterable[Maps]) -> None:
        every = list(maps)
        if not every:
            raise UsageError("There are no training maps. Give the dataset's folder.")
        step = max(1, -(-len(every) // MOST_MAPS))
        self.maps = np.stack(every[::step])
        self.logs = np.log(np.maximum(self.maps, _DARKEST))

    def mean(self) -> Maps:
        """The mean map, of logs."""
        return np.asarray(np.exp(self.logs.mean(axis=0)), np.float32)

    def nearest(self, truth: Maps) -> Maps:
        """The map with the least mean squared difference of logs, by solid angle."""
        weights = row_solid_angles(truth.shape[0], truth.shape[1])[:, None, None]
        wanted = np.log(np.maximum(truth, _DARKEST))
        away = [float((weights * (one - wanted) ** 2).sum()) for one in self.logs]
        return np.asarray(self.maps[int(np.argmin(away))])


class MeanMap:
    """The mean map, whatever is seen."""

    name = "mean map"

    def __init__(self, training: TrainingMaps) -> None:
        self._map = training.mean()

    def predict(self, sample: StereoSample) -> Maps:
        """(64, 64, 3)."""
        return self._map


class RandomMap:
    """A map of the training split, chosen by the sample's key."""

    name = "random map"

    def __init__(self, training: TrainingMaps, seed: int = 0) -> None:
        self._training = training
        self._seed = seed

    def predict(self, sample: StereoSample) -> Maps:
        """(64, 64, 3)."""
        rng = np.random.default_rng([self._seed, int(sample.key)])
        return np.asarray(self._training.maps[rng.integers(len(self._training.maps))])


class NearestMap:
    """The training map nearest to the truth: not a method, a bound on memory."""

    name = "nearest map (oracle)"

    def __init__(self, training: TrainingMaps) -> None:
        self._training = training

    def predict(self, sample: StereoSample) -> Maps:
        """(64, 64, 3)."""
        return self._training.nearest(sample.truth)


class AmbientColor:
    """One color everywhere: the mean of the left view, as ambient-light estimates of phones."""

    name = "ambient color"

    def predict(self, sample: StereoSample) -> Maps:
        """(64, 64, 3)."""
        color = srgb_decode_u8(sample.views.left).reshape(-1, 3).mean(axis=0)
        return np.broadcast_to(color.astype(np.float32), (64, 64, 3)).copy()

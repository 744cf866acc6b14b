"""Predictions that hardly look: what any method has to beat.

All figures of a comparison come with these, computed on the same samples. The mean map is the mean
of the logs of the training maps; the random map is one of them; the nearest map is the one of
them nearest to the *truth*, which no method can know: how far memory alone could get.
"""

import hashlib
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_decode_u8
from panokit.errors import UsageError
from panokit.evaluate.lighting.sample import StereoSample
from panokit.sphere.solid_angle import row_solid_angles
from panokit.stereo import Views

Maps = NDArray[np.float32]
MOST_MAPS = 4000
# Before logs: below a thousandth of the pictures' white nothing is seen of the light.
_DARKEST = 1e-3


class TrainingMaps:
    """The maps of a training split, (N, 64, 64, 3) float32.

    Args:
        maps: One for each sample; at most `most` of them are kept, evenly over all.
        most: See `maps`.
    """

    def __init__(self, maps: Iterable[Maps], most: int = MOST_MAPS) -> None:
        every = list(maps)
        if not every:
            raise UsageError(
                'There are no training maps: the split "train" is empty. Render more samples.'
            )
        step = max(1, -(-len(every) // most))
        self.maps = np.stack(every[::step])
        self.digest = hashlib.sha256(self.maps[:, ::4, ::4].tobytes()).hexdigest()[:16]
        self._flat = np.stack([_coarse_logs(one) for one in self.maps])
        self._squares = (self._flat.astype(np.float64) ** 2).sum(axis=1)

    def mean(self) -> Maps:
        """The mean map, of logs."""
        logs = np.zeros(self.maps.shape[1:], np.float64)
        for one in self.maps:
            logs += np.log(np.maximum(one, _DARKEST))
        return np.asarray(np.exp(logs / len(self.maps)), np.float32)

    def nearest(self, truth: Maps) -> Maps:
        """The map with the least difference of logs, see `distance`."""
        return np.asarray(self.maps[int(np.argmin(self._distances(truth)))])

    def distance(self, estimate: Maps) -> float:
        """How far a map is from the nearest training map: see `log_distance`."""
        return float(self._distances(estimate).min())

    def _distances(self, wanted: Maps) -> NDArray[np.float64]:
        flat = _coarse_logs(wanted)
        products = (self._flat @ flat).astype(np.float64)
        squares = self._squares - 2 * products + float((flat.astype(np.float64) ** 2).sum())
        return np.sqrt(np.maximum(squares, 0))


def log_distance(one: Maps, other: Maps) -> float:
    """The root of the mean squared difference of logs (decades), by solid angle, at 16x16."""
    return float(np.linalg.norm(_coarse_logs(one) - _coarse_logs(other)))


def _coarse_logs(radiance: Maps) -> NDArray[np.float32]:
    """Logs of a (64, 64, 3) map in 16x16 blocks, flat; differences have `log_distance` length."""
    logs = np.log10(np.maximum(radiance, _DARKEST)).reshape(16, 4, 16, 4, 3).mean(axis=(1, 3))
    weights = row_solid_angles(16, 16)[:, None, None] / (4 * np.pi * 3)
    return np.asarray(logs * np.sqrt(weights), np.float32).reshape(-1)


class MeanMap:
    """The mean map, whatever is seen."""

    name = "mean map"

    def __init__(self, training: TrainingMaps) -> None:
        self._map = training.mean()
        self.digest = f"mean map 1 {training.digest}"

    def predict(self, sample: StereoSample) -> Maps:
        """(64, 64, 3)."""
        return self._map


class RandomMap:
    """A map of the training split, chosen by the sample's key."""

    name = "random map"

    def __init__(self, training: TrainingMaps, seed: int = 0) -> None:
        self._training = training
        self._seed = seed
        self.digest = f"random map 1 {training.digest}-{seed}"

    def predict(self, sample: StereoSample) -> Maps:
        """(64, 64, 3)."""
        rng = np.random.default_rng([self._seed, int(sample.key)])
        return np.asarray(self._training.maps[rng.integers(len(self._training.maps))])


class NearestMap:
    """The training map nearest to the truth: not a method, a bound on memory."""

    name = "nearest map (oracle)"

    def __init__(self, training: TrainingMaps) -> None:
        self._training = training
        self.digest = f"nearest map (oracle) 1 {training.digest}"

    def predict(self, sample: StereoSample) -> Maps:
        """(64, 64, 3)."""
        return self._training.nearest(sample.truth)


class AmbientColor:
    """One color everywhere: the mean of the left view, as ambient-light estimates of phones."""

    name = "ambient color"
    digest = "ambient color 1"

    def predict(self, sample: StereoSample) -> Maps:
        """(64, 64, 3)."""
        return ambient_map(sample.views)


def ambient_map(views: Views) -> Maps:
    """(64, 64, 3), in every direction the mean radiance of the left view."""
    color = srgb_decode_u8(views.left).reshape(-1, 3).mean(axis=0)
    return np.broadcast_to(color.astype(np.float32), (64, 64, 3)).copy()

"""The saturated-area rule, fitted to the probes of the other folds: a fair baseline.

For every picture it is enough to know how much each burnt-out component gives to each of the
six axes, so the fit costs nothing once the pictures are taken.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from panokit.color import luminance
from panokit.expand.baselines import SHIPPED_AREA_RULE, AreaRule
from panokit.expand.components import find_components
from panokit.expand.reduce import reduce_panorama
from panokit.metrics.lighting import SIX_AXES
from panokit.sphere import equirect_directions, irradiance, row_solid_angles

# Fewer pictures than this say nothing that the shipped rule does not say better.
_FEWEST = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class AreaRecord:
    """What the rule needs to know of a picture.

    Attributes:
        fold: Of its probe.
        log_area: Of each component, K of them.
        received: (K, 6), what each component gives to the six axes as the picture shows it.
        rest: (6,), what everything else gives.
        true: (6,), what the true map gives.
    """

    fold: int
    log_area: tuple[float, ...]
    received: tuple[tuple[float, ...], ...]
    rest: tuple[float, ...]
    true: tuple[float, ...]

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {name: getattr(self, name) for name in self.__slots__}


def area_record(pixels: NDArray[np.uint8], truth: NDArray[np.float32], fold: int) -> AreaRecord:
    """Measure a picture against its truth, in units of the clip level."""
    reduced = reduce_panorama(pixels, pixels.shape[1])
    components = find_components(reduced)
    height, width = reduced.share.shape
    directions = equirect_directions(width, height)
    shown = luminance(reduced.burnt) * row_solid_angles(height, width)[:, None]
    received = []
    for k in range(len(components)):
        inside = components.labels == k + 1
        facing = np.maximum(directions[inside] @ SIX_AXES.T, 0)
        received.append(shown[inside] @ facing)
    lit = np.reshape(received, (-1, 6))
    whole = luminance(irradiance(reduced.linear, SIX_AXES))
    return AreaRecord(
        fold=fold,
        log_area=tuple(np.log(components.solid_angle).tolist()),
        received=tuple(map(tuple, lit.tolist())),
        rest=tuple((whole - lit.sum(axis=0)).tolist()),
        true=tuple(luminance(irradiance(truth, SIX_AXES)).tolist()),
    )


def fit_rules(records: Sequence[AreaRecord], folds: Sequence[int]) -> dict[int, AreaRule]:
    """For each fold, the rule that errs least on the pictures of all other folds."""
    return {
        fold: fit_rule([record for record in records if record.fold != fold])
        for fold in sorted(set(folds))
    }


def fit_rule(records: Sequence[AreaRecord]) -> AreaRule:
    """The rule that errs least on some pictures.

    The error is the mean relative one of irradiance on the six axes: the figure that the rule
    is then judged by, so that it is as hard to beat as it can be. With too few pictures the
    shipped rule stands in.
    """
    if len(records) < _FEWEST:
        return SHIPPED_AREA_RULE
    most = max(len(record.log_area) for record in records)
    log_area = np.zeros((len(records), most))
    received = np.zeros((len(records), most, 6))
    for i, record in enumerate(records):
        count = len(record.log_area)
        log_area[i, :count] = record.log_area
        received[i, :count] = np.reshape(record.received, (-1, 6))
    rest = np.array([record.rest for record in records])
    true = np.array([record.true for record in records])

    def error(numbers: NDArray[np.float64]) -> float:
        gain = np.exp(np.clip(numbers[0] + numbers[1] * log_area, 0, 12))
        guess = rest + np.einsum("bk,bkn->bn", gain, received)
        return float(np.mean(np.abs(guess / np.maximum(true, 1e-9) - 1)))

    found = minimize(error, np.array([0.7, -0.3]), method="Nelder-Mead")
    offset, slope = found.x
    return AreaRule(offset=round(float(offset), 4), slope=round(float(slope), 4))

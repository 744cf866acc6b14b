"""How sure a model may be: its disagreement with its mirrored self beside its true error.

Half of the samples give the curves, the other half tells what they are worth.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.stats import spearmanr

from panokit.errors import StorageError, UsageError
from panokit.evaluate.lighting.sample import StereoSample
from panokit.io.files import write_bytes
from panokit.reflectance.calibration import Calibration, Curve
from panokit.reflectance.light_network import LightNetwork
from panokit.reflectance.mirroring import (
    direction_difference_deg,
    log_difference,
    read_twice,
)
from panokit.sphere.solid_angle import row_solid_angles

_FEWEST = 20
# Points of a curve, and every so many-th pixel in each direction: neighbors say the same.
_POINTS, _STRIDE = 12, 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Reliability:
    """What a calibration is worth on samples that it was not measured on.

    Attributes:
        count: Of those samples.
        expected: The mean |log| error that was foretold.
        observed: That there was.
        off: The mean of |expected - observed| over ten groups of equal size by what was foretold.
        rank: Spearman's correlation of foretold and true error, over whole maps.
        rank_direction: The same for the direction of the light.
    """

    count: int
    expected: float
    observed: float
    off: float
    rank: float
    rank_direction: float


def calibrate_confidence(
    network: LightNetwork, samples: Sequence[StereoSample]
) -> tuple[Calibration, Reliability]:
    """Measure on samples that the model has not learned from, best those of validation.

    Args:
        network: The model.
        samples: At least 20; every second one is kept to check.

    Raises:
        UsageError: If there are too few.
    """
    if len(samples) < _FEWEST:
        raise UsageError(
            f"A calibration needs at least {_FEWEST} samples, not {len(samples)}. Render more."
        )
    signals, errors, angles = [], [], []
    for sample in samples:
        plain, other = read_twice(network, sample.views)
        signals.append(_thinned(log_difference(plain, other)))
        errors.append(_thinned(log_difference(plain, sample.truth)))
        angles.append(
            (direction_difference_deg(plain, other), direction_difference_deg(plain, sample.truth))
        )
    signal, error, angle = (np.array(values, np.float64) for values in (signals, errors, angles))
    calibration = Calibration(
        count=len(samples[::2]),
        radiance=fit_curve(signal[::2].ravel(), error[::2].ravel(), _thinned_weights(signal[::2])),
        direction_deg=fit_curve(angle[::2, 0], angle[::2, 1]),
    )
    return calibration, _reliability(calibration, signal[1::2], error[1::2], angle[1::2])


def fit_curve(
    signal: NDArray[np.float64],
    error: NDArray[np.float64],
    weights: NDArray[np.float64] | None = None,
) -> Curve:
    """The mean error by the signal, as a curve that never falls.

    Groups of equal size, their means, and neighbors that fall are joined until none does
    (pool adjacent violators, Ayer et al. 1955).

    Raises:
        UsageError: If all signals are the same: then they tell nothing.
    """
    weights = np.ones_like(signal) if weights is None else weights
    order = np.argsort(signal, kind="stable")
    groups: list[list[float]] = []
    for part in np.array_split(order, min(_POINTS, len(order))):
        mass = float(weights[part].sum())
        groups.append([float((weights[part] * signal[part]).sum() / mass),
                       float((weights[part] * error[part]).sum() / mass), mass])  # fmt: skip
        while len(groups) > 1 and (
            groups[-1][1] < groups[-2][1] or groups[-1][0] <= groups[-2][0] + 1e-9
        ):
            last, before = groups.pop(), groups.pop()
            mass = last[2] + before[2]
            groups.append(
                [*((last[k] * last[2] + before[k] * before[2]) / mass for k in (0, 1)), mass]
            )
    if len(groups) == 1:
        if float(np.ptp(signal)) <= 1e-9:
            raise UsageError("All signals are the same, so they tell nothing of errors.")
        low, high = float(signal.min()), float(signal.max())
        return Curve(signal=(low, high), error=(groups[0][1], groups[0][1]))
    return Curve(signal=tuple(g[0] for g in groups), error=tuple(g[1] for g in groups))


def write_calibration(folder: Path, calibration: Calibration) -> None:
    """Put the table [lighting.confidence] into a model's model.toml, in place of an older one.

    Raises:
        StorageError: If the file cannot be read or written.
    """
    path = folder / "model.toml"
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise StorageError(f"Cannot read {path}: {error.strerror}.") from error
    kept, inside = [], False
    for line in text.splitlines():
        if line.startswith("["):
            inside = line.strip() == "[lighting.confidence]"
        if not inside:
            kept.append(line)
    body = "\n".join(kept).rstrip("\n")
    write_bytes(path, f"{body}\n\n{calibration.to_toml()}".encode())


def _reliability(
    calibration: Calibration,
    signal: NDArray[np.float64],
    error: NDArray[np.float64],
    angle: NDArray[np.float64],
) -> Reliability:
    expected = calibration.radiance(signal)
    weights = _thinned_weights(signal).reshape(expected.shape)
    order = np.argsort(expected.ravel(), kind="stable")
    gaps = []
    for part in np.array_split(order, 10):
        mass = weights.ravel()[part]
        gap = (mass * (expected.ravel()[part] - error.ravel()[part])).sum() / mass.sum()
        gaps.append(abs(float(gap)))
    told, true = ((weights * one).sum(axis=1) / weights.sum(axis=1) for one in (expected, error))
    return Reliability(
        count=len(signal),
        expected=float(told.mean()),
        observed=float(true.mean()),
        off=float(np.mean(gaps)),
        rank=_rank(told, true),
        rank_direction=_rank(calibration.direction_deg(angle[:, 0]), angle[:, 1]),
    )


def _rank(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Spearman's correlation, 0 where one of them is constant."""
    if np.ptp(one) == 0 or np.ptp(other) == 0:
        return 0.0
    return float(spearmanr(one, other).statistic)


def _thinned(values: NDArray[np.float32]) -> NDArray[np.float32]:
    return values[_STRIDE // 2 :: _STRIDE, _STRIDE // 2 :: _STRIDE].ravel()


def _thinned_weights(signal: NDArray[np.float64]) -> NDArray[np.float64]:
    rows = row_solid_angles(64, 64)[_STRIDE // 2 :: _STRIDE]
    return np.tile(np.repeat(rows, 64 // _STRIDE), len(signal))

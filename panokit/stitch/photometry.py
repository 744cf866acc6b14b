"""Exposure and vignetting of overlapping views, from what they show of the same directions.

Model, in linear light: view i shows `gain_i * falloff(r) * scene`, with one gain per view and
channel, and one falloff `exp(a1 r^2 + a2 r^4)` for the lens that all views share. Its
logarithm is linear in everything sought, so it is one least-squares problem; the scene is
eliminated by taking away the mean over the views of each direction. Weights after Cauchy
make what moved between two views, or reflects, count little (iteratively reweighted).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.stitch.overlaps import Overlaps

_ROUNDS = 6
_FLOOR = 0.004  # of linear light: below it noise and the foot of the curve rule
_SOFT = 0.02
# How far gains and the falloff stray when nothing speaks for it; weak against any overlap.
_GAIN_SPREAD, _FALLOFF_SPREAD = 1.5, 0.5
_LEAST_NOISE = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Photometry:
    """How each view was exposed.

    Attributes:
        gain: (V, 3) by which a view is brighter than the scene, of geometric mean 1.
        falloff: (a1, a2): at squared radius r2 the lens passes exp(a1 r2 + a2 r2^2).
        matched: (V,) bool: the view shares enough with others to say so.
        spread: Typical difference that remains, in log units.
    """

    gain: NDArray[np.float64]
    falloff: tuple[float, float]
    matched: NDArray[np.bool_]
    spread: float

    @classmethod
    def none(cls, count: int) -> "Photometry":
        """All views are as they should be."""
        return cls(np.ones((count, 3)), (0.0, 0.0), np.zeros(count, np.bool_), 0.0)

    def passes(self, radius2: NDArray[np.float32]) -> NDArray[np.float32]:
        """The share of light that the lens passes at squared radii."""
        a1, a2 = (np.float32(a) for a in self.falloff)
        return np.exp(a1 * radius2 + a2 * radius2 * radius2)


def fit_photometry(samples: Overlaps, *, vignette: bool = True) -> Photometry:
    """Find gains and falloff.

    Args:
        samples: What the views show of the same directions.
        vignette: Also fit the falloff; else it is none.
    """
    count = len(samples.weight)
    brightness = samples.linear.mean(axis=-1)
    # Log of dark values is noise; they count less, and below the floor not at all.
    trust = np.square(brightness / (brightness + _SOFT)) * (brightness > _FLOOR)
    weight = samples.weight * trust
    weight[:, (weight > 0).sum(axis=0) < 2] = 0
    used = np.flatnonzero(weight.any(axis=0))
    matched = (weight > 0).sum(axis=1) >= 8
    if not len(used):
        return Photometry.none(count)
    weight = weight[:, used]
    weight /= weight.mean(where=weight > 0)
    logs = np.log(np.maximum(samples.linear[:, used], _FLOOR / 4))
    radius2 = samples.radius2[:, used]
    shapes = [radius2, np.square(radius2)] if vignette else []
    gains, falloff, spread = _solve(logs, weight, shapes)
    gains[~matched] = 0
    if matched.any():
        gains -= gains[matched].mean(axis=0)
        gains[~matched] = 0
    return Photometry(np.exp(gains), falloff, matched, spread)


def _solve(
    logs: NDArray[np.float32], weight: NDArray[np.float32], shapes: list[NDArray[np.float32]]
) -> tuple[NDArray[np.float64], tuple[float, float], float]:
    """Reweighted least squares; log gains (V, 3), falloff, remaining spread."""
    count = len(weight)
    gray = logs.mean(axis=-1)
    robust = weight.copy()
    solution = np.zeros(count + len(shapes))
    noise = 0.3
    for _ in range(_ROUNDS):
        solution = _least_squares(gray, robust, shapes, noise)
        fitted = gray - solution[:count, None].astype(np.float32)
        for shape, factor in zip(shapes, solution[count:], strict=True):
            fitted -= np.float32(factor) * shape
        residual = fitted - _mean(fitted, robust)
        noise = max(_scale(residual, weight), _LEAST_NOISE)
        robust = weight / (1 + np.square(residual / (2 * noise)))
    lens = solution[count:]
    vignette = sum(
        (np.float32(f) * s for f, s in zip(lens, shapes, strict=True)), np.zeros_like(gray)
    )
    gains = np.stack(
        [_least_squares(logs[..., c] - vignette, robust, [], noise) for c in range(3)], axis=-1
    )
    return gains, (float(lens[0]), float(lens[1])) if len(lens) else (0.0, 0.0), noise


def _least_squares(
    values: NDArray[np.float32],
    weight: NDArray[np.float32],
    shapes: list[NDArray[np.float32]],
    noise: float,
) -> NDArray[np.float64]:
    """Solve `values[v, p] = x_v + sum_k x_k shapes_k[v, p] + scene[p]` for x, the scene aside."""
    count, size = len(weight), len(weight) + len(shapes)
    total = np.maximum(weight.sum(axis=0), 1e-12)
    share = weight / total
    matrix, right = np.zeros((size, size)), np.zeros(size)
    matrix[:count, :count] = np.diag(weight.sum(axis=1)) - share @ weight.T
    weighted = weight * (values - (share * values).sum(axis=0))
    right[:count] = weighted.sum(axis=1)
    centered = [shape - (share * shape).sum(axis=0) for shape in shapes]
    for k, shape in enumerate(centered):
        column = weight * shape
        matrix[:count, count + k] = matrix[count + k, :count] = column.sum(axis=1)
        for other in range(k + 1):
            both = (column * centered[other]).sum()
            matrix[count + k, count + other] = matrix[count + other, count + k] = both
        right[count + k] = (weighted * shape).sum()
    spreads = [_GAIN_SPREAD] * count + [_FALLOFF_SPREAD] * len(shapes)
    # Beside the prior a little more, above the rounding of sums in single precision, so that
    # groups of views that share nothing stay where they are.
    rounding = 1e-4 * float(weight.sum()) / count
    matrix[np.diag_indices(size)] += np.square(noise / np.array(spreads)) + rounding
    return np.asarray(np.linalg.solve(matrix, right), np.float64)


def _mean(values: NDArray[np.float32], weight: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray(
        (weight * values).sum(axis=0) / np.maximum(weight.sum(axis=0), 1e-12), np.float32
    )


def _scale(residual: NDArray[np.float32], weight: NDArray[np.float32]) -> float:
    """Robust standard deviation: the median of absolute values of a normal one is 0.6745 of it."""
    used = np.abs(residual[weight > 0])
    return float(np.median(used)) / 0.6745 if used.size else 0.0

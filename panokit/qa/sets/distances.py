"""One figure in two sets: how far its distributions are apart, and how sure that is."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.qa.sets.resampling import (
    TwoSets,
    bootstrap_weights,
    p_value,
    permuted_labels,
    weighted_quantiles,
)

Array = NDArray[np.float64]

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
_INTERVAL = (2.5, 97.5)
_NULL = 95.0
# Numbers worked on at once.
_AT_ONCE = 1 << 22


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """A figure with its 95 % bootstrap interval."""

    value: float
    low: float
    high: float

    @property
    def is_clear(self) -> bool:
        """Whether the interval leaves out zero."""
        return self.low > 0 or self.high < 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Shift:
    """How a figure differs from one set to the other.

    Lengths are in units of `scale`. A distance is never negative, so that its bootstrap
    interval lies too high where the sets are alike; `distance_null` is what sets of one
    distribution stay under in 95 of 100 cases, and says whether there is a difference at all.

    Attributes:
        scale: The reference's interquartile range, or what stands for it where that is 0.
        reference: Quantiles 5, 25, 50, 75, 95 % of the reference.
        augmented: The same of the augmented set.
        shift: The augmented median minus the reference's.
        distance: Wasserstein-1, the area between the distribution functions.
        distance_null: Its 95th percentile under shuffled labels.
        p: Of the distance, by shuffled labels.
        ks: Kolmogorov and Smirnov's largest difference of the distribution functions.
        ks_p: Of that, by shuffled labels.
        outside: The share of augmented maps outside the reference's 5 to 95 % range.
        below: The share below it.
        above: The share above it.
        spread: The augmented interquartile range over the reference's, None where that is 0.
    """

    scale: float
    reference: tuple[float, ...]
    augmented: tuple[float, ...]
    shift: Interval
    distance: Interval
    distance_null: float
    p: float
    ks: float
    ks_p: float
    outside: Interval
    below: float
    above: float
    spread: Interval | None

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return asdict(self)


def robust_scale(values: Array) -> float:
    """The interquartile range; where that is 0 the sd times 1.35, as of a normal; 0 if equal."""
    low, high = weighted_quantiles(np.sort(values), np.ones((1, len(values))), (0.25, 0.75))[0]
    if high > low:
        return float(high - low)
    spread = 1.349 * float(values.std())
    # The rounding of a sum is no spread.
    return spread if spread > 1e-12 * max(float(np.abs(values).max()), 1e-300) else 0.0


def shift_between(
    augmented: Sequence[float],
    reference: Sequence[float],
    sets: TwoSets,
    *,
    permutations: int = 999,
    resamples: int = 1000,
    seed: int = 0,
) -> Shift | None:
    """Compare one figure of two sets; None where it is the same number in every map.

    Args:
        augmented: (n,) finite values.
        reference: (m,) finite values.
        sets: Which of them belong together, in the same order.
        permutations: Shuffles for the p values.
        resamples: Bootstrap draws for the intervals.
        seed: Of both.

    Raises:
        UsageError: If the lengths do not fit, or a value is not finite.
    """
    values = np.concatenate([np.asarray(augmented, np.float64), np.asarray(reference, np.float64)])
    n = len(augmented)
    if n != len(sets.augmented) or len(reference) != len(sets.reference):
        raise UsageError(
            f"There are {n} and {len(reference)} values for {len(sets.augmented)} and "
            f"{len(sets.reference)} maps."
        )
    if not np.isfinite(values).all():
        raise UsageError("Figures of two sets are finite; leave out the maps that have none.")
    scale = robust_scale(values[n:]) or robust_scale(values)
    if scale <= 0:
        return None
    order = np.argsort(values, kind="stable")
    values, is_augmented = values[order], sets.labels[order]
    seen = _statistics(values, is_augmented[None].astype(np.float64), scale)
    drawn = bootstrap_weights(sets, resamples, seed)[:, order]
    booted = _in_parts(values, drawn, is_augmented, scale)
    shuffles = permuted_labels(sets, permutations, seed)[:, order]
    nulls = _distances(values, shuffles.astype(np.float64), (~shuffles).astype(np.float64), scale)

    def interval(name: str) -> Interval:
        spread = booted[name][np.isfinite(booted[name])]
        low, high = np.percentile(spread, _INTERVAL) if len(spread) else (np.nan, np.nan)
        return Interval(value=float(seen[name][0]), low=float(low), high=float(high))

    return Shift(
        scale=scale,
        reference=tuple(float(q) for q in seen["reference"][0]),
        augmented=tuple(float(q) for q in seen["augmented"][0]),
        shift=interval("shift"),
        distance=interval("distance"),
        distance_null=float(np.percentile(nulls[0], _NULL)),
        p=p_value(float(seen["distance"][0]), nulls[0]),
        ks=float(seen["ks"][0]),
        ks_p=p_value(float(seen["ks"][0]), nulls[1]),
        outside=interval("outside"),
        below=float(seen["below"][0]),
        above=float(seen["above"][0]),
        spread=interval("spread") if np.isfinite(seen["spread"][0]) else None,
    )


def _in_parts(
    values: Array, weights: Array, is_augmented: NDArray[np.bool_], scale: float
) -> dict[str, Array]:
    """`_statistics` of many draws, some at a time."""
    step = max(_AT_ONCE // len(values), 1)
    parts = []
    for start in range(0, len(weights), step):
        part = weights[start : start + step]
        parts.append(_statistics(values, part * is_augmented, scale, part * ~is_augmented))
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _statistics(
    values: Array, augmented: Array, scale: float, reference: Array | None = None
) -> dict[str, Array]:
    """Every figure of `Shift` under many weightings (draws, N) of sorted values (N,)."""
    reference = 1.0 - augmented if reference is None else reference
    quantiles_r = weighted_quantiles(values, reference, QUANTILES)
    quantiles_a = weighted_quantiles(values, augmented, QUANTILES)
    total = augmented.sum(axis=1)
    below = (augmented * (values < quantiles_r[:, :1])).sum(axis=1) / total
    above = (augmented * (values > quantiles_r[:, -1:])).sum(axis=1) / total
    spread_r = quantiles_r[:, 3] - quantiles_r[:, 1]
    spread_a = quantiles_a[:, 3] - quantiles_a[:, 1]
    distance, ks = _distances(values, augmented, reference, scale)
    return {
        "reference": quantiles_r,
        "augmented": quantiles_a,
        "shift": (quantiles_a[:, 2] - quantiles_r[:, 2]) / scale,
        "distance": distance,
        "ks": ks,
        "below": below,
        "above": above,
        "outside": below + above,
        "spread": np.where(spread_r > 0, spread_a / np.where(spread_r > 0, spread_r, 1), np.nan),
    }


def _distances(
    values: Array, augmented: Array, reference: Array, scale: float
) -> tuple[Array, Array]:
    """Wasserstein-1 over the scale, and Kolmogorov-Smirnov, of sorted values."""
    gaps = np.diff(values) / scale
    apart = np.cumsum(augmented, axis=1) / augmented.sum(axis=1, keepdims=True)
    apart -= np.cumsum(reference, axis=1) / reference.sum(axis=1, keepdims=True)
    apart = np.abs(apart[:, :-1])
    return apart @ gaps, np.max(apart * (gaps > 0), axis=1, initial=0.0)

"""Shuffled labels and bootstraps for two sets of maps that may share scenes.

Maps of one place are not independent of each other, and a map and its own truth are less so. So
a bootstrap draws groups, whole (Davison and Hinkley 1997, section 3.8), and where both sets hold
a group, both have it drawn alike; a permutation exchanges labels within such a group, which for
one map against its truth is the classical exchange within pairs, and elsewhere moves whole
groups from set to set.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TwoSets:
    """Which maps of two sets stand for one place.

    Attributes:
        augmented: (n,) the number of each augmented map's group.
        reference: (m,) the number of each reference map's group.
    """

    augmented: NDArray[np.intp]
    reference: NDArray[np.intp]

    @property
    def pooled(self) -> NDArray[np.intp]:
        """(n + m,) the groups of the augmented maps, then of the reference maps."""
        return np.concatenate([self.augmented, self.reference])

    @property
    def shared(self) -> NDArray[np.intp]:
        """The groups that both sets hold."""
        return np.intersect1d(self.augmented, self.reference)

    @property
    def labels(self) -> NDArray[np.bool_]:
        """(n + m,) True for the augmented maps."""
        return np.arange(len(self.pooled)) < len(self.augmented)


def two_sets(augmented: Sequence[str], reference: Sequence[str]) -> TwoSets:
    """Number the groups of two sets by their names.

    Raises:
        UsageError: If a set is empty.
    """
    if not augmented or not reference:
        raise UsageError("Two sets to compare hold at least one map each; one of them is empty.")
    numbers: dict[str, int] = {}
    for name in (*augmented, *reference):
        numbers.setdefault(name, len(numbers))
    return TwoSets(
        augmented=np.array([numbers[name] for name in augmented], np.intp),
        reference=np.array([numbers[name] for name in reference], np.intp),
    )


@lru_cache(maxsize=2)
def permuted_labels(sets: TwoSets, count: int, seed: int) -> NDArray[np.bool_]:
    """Labels as they might have been if both sets were one, (count, n + m) bool, read-only."""
    random = np.random.default_rng([seed, 0x7065726D])
    pooled, labels = sets.pooled, sets.labels
    shuffled = np.zeros((count, len(pooled)), bool)
    shared = np.isin(pooled, sets.shared)
    for group in sets.shared:
        here = np.flatnonzero(pooled == group)
        shuffled[:, here] = random.permuted(np.tile(labels[here], (count, 1)), axis=1)
    apart = np.flatnonzero(~shared)
    if len(apart):
        _, member = np.unique(pooled[apart], return_inverse=True)
        sizes = np.bincount(member)
        wanted = int(labels[apart].sum())
        for row in range(count):
            order = random.permutation(len(sizes))
            middles = np.cumsum(sizes[order]) - sizes[order] / 2
            taken = np.zeros(len(sizes), bool)
            taken[order[middles < wanted]] = True
            shuffled[row, apart] = taken[member]
    shuffled.setflags(write=False)
    return shuffled


@lru_cache(maxsize=2)
def bootstrap_weights(sets: TwoSets, count: int, seed: int) -> Array:
    """How often each map is drawn, (count, n + m) float64, read-only.

    Groups of the augmented set alone, of the reference alone and of both are drawn apart, so
    that each draw has as many of each kind as there are.
    """
    random = np.random.default_rng([seed, 0x626F6F74])
    only_a = np.setdiff1d(sets.augmented, sets.reference)
    only_r = np.setdiff1d(sets.reference, sets.augmented)
    drawn = np.zeros((count, int(sets.pooled.max()) + 1))
    for groups in (sets.shared, only_a, only_r):
        if len(groups):
            times = random.multinomial(len(groups), np.full(len(groups), 1 / len(groups)), count)
            drawn[:, groups] = times
    weights = drawn[:, sets.pooled]
    weights.setflags(write=False)
    return weights


def weighted_quantiles(values: Array, weights: Array, shares: Sequence[float]) -> Array:
    """Quantiles of values under many weightings, (draws, len(shares)).

    The inverse of the distribution, with the mean of both ends where it is flat (definition 2
    of Hyndman and Fan 1996): the median of an even number is the usual one.

    Args:
        values: (N,), sorted.
        weights: (draws, N), of the values in that order; each draw has some weight.
        shares: 0 to 1.
    """
    reached = np.cumsum(weights, axis=1)
    total = reached[:, -1:]
    found = np.empty((len(weights), len(shares)))
    for column, share in enumerate(shares):
        wanted = share * total
        slack = 1e-9 * total
        first = (reached < wanted - slack).sum(axis=1)
        last = np.minimum((reached <= wanted + slack).sum(axis=1), len(values) - 1)
        # At a share of 1 nothing lies beyond; at 0 nothing before.
        last = np.where(wanted[:, 0] >= total[:, 0] - slack[:, 0], first, last)
        found[:, column] = (values[np.minimum(first, len(values) - 1)] + values[last]) / 2
    return found


def p_value(observed: float, shuffled: Array) -> float:
    """The share of shuffles as extreme as what was seen, which itself counts as one of them.

    Phipson and Smyth 2010, "Permutation P-values Should Never Be Zero".
    """
    as_far = int((shuffled >= observed * (1 - 1e-12)).sum())
    return (as_far + 1) / (len(shuffled) + 1)


def false_discovery_rates(p_values: Sequence[float]) -> list[float]:
    """Benjamini and Hochberg 1995: the rate of false alarms if this and all smaller are told."""
    p = np.asarray(p_values, np.float64)
    if not len(p):
        return []
    order = np.argsort(p)[::-1]
    rates = p[order] * len(p) / np.arange(len(p), 0, -1)
    adjusted = np.empty(len(p))
    adjusted[order] = np.minimum.accumulate(np.minimum(rates, 1.0))
    return [float(rate) for rate in adjusted]

"""Two sets by all figures at once: energy distance, MMD, Frechet distance, precision and recall.

A set can have every figure right and their combinations wrong: suns at midnight. These see it,
but say less of what is wrong than the figures one by one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from panokit.metrics.frechet import frechet_distance
from panokit.qa.sets.resampling import TwoSets, p_value, permuted_labels

Array = NDArray[np.float64]

# One broken figure must not decide alone: beyond so many interquartile ranges all is equally far.
_FARTHEST = 10.0
_FRECHET_SHUFFLES = 199
_FRECHET_DEGREES = slice(1, 9)
_SPLITS = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Separation:
    """A distance between two sets with what chance makes of it.

    Attributes:
        value: Of the two sets.
        expected: The mean under shuffled labels: what two sets of one distribution and of
            these sizes have, which is not 0 where the estimate is biased.
        null: The 95th percentile under shuffled labels.
        p: The share of shuffles as far apart.
    """

    value: float
    expected: float
    null: float
    p: float

    @property
    def excess(self) -> float:
        """The value without its bias."""
        return self.value - self.expected


@dataclass(frozen=True, slots=True, kw_only=True)
class Neighborhood:
    """How two sets cover each other, in neighborhoods of the k nearest maps.

    Attributes:
        k: Of the k nearest.
        precision: The share of augmented maps that lie in a reference map's neighborhood.
        recall: The share of reference maps that lie in an augmented map's (both Kynkäänniemi
            et al. 2019).
        density: In how many reference neighborhoods an augmented map lies, over k.
        coverage: The share of reference neighborhoods with an augmented map (both Naeem et
            al. 2020).
        expected: The same four figures of two halves of the reference, on average; None
            where it is too small to halve.
    """

    k: int
    precision: float
    recall: float
    density: float
    coverage: float
    expected: Mapping[str, float] | None = None

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {**asdict(self), "expected": dict(self.expected) if self.expected else None}


def standardized(
    augmented: Sequence[Mapping[str, float | None]], reference: Sequence[Mapping[str, float | None]]
) -> tuple[Array, Array, tuple[str, ...]]:
    """Figures as vectors, centered and scaled by the reference's median and quartiles.

    Figures that some map has not, or that are one number in half of the reference, are left out.

    Returns:
        (n, d) and (m, d) float64 within plus and minus 10, and the names of the d figures.
    """
    pooled = [*augmented, *reference]
    used, columns = [], []
    for name in pooled[0]:
        values = [figures[name] for figures in pooled]
        if any(value is None for value in values):
            continue
        column = np.array(values, np.float64)
        of_reference = column[len(augmented) :]
        low, high = np.percentile(of_reference, [25, 75])
        if high > low:
            used.append(name)
            columns.append((column - np.median(of_reference)) / (high - low))
    vectors = np.clip(np.stack(columns, axis=1), -_FARTHEST, _FARTHEST)
    return vectors[: len(augmented)], vectors[len(augmented) :], tuple(used)


def energy_and_kernel(
    augmented: Array, reference: Array, sets: TwoSets, *, permutations: int = 999, seed: int = 0
) -> tuple[Separation, Separation]:
    """The energy distance and the kernel distance (MMD) between two sets of vectors.

    Energy: 2 E|X - Y| - E|X - X'| - E|Y - Y'| (Székely and Rizzo 2013). MMD^2: the same with
    minus a Gaussian kernel in place of the distance, its width the median distance of all
    pairs (Gretton et al. 2012). Both without a map's distance to itself, so that neither is
    biased; both can therefore come out a little below 0.
    """
    vectors = np.concatenate([augmented, reference])
    distances = cdist(vectors, vectors)
    width = float(np.median(distances[np.triu_indices(len(vectors), 1)])) or 1.0
    labels = np.concatenate([sets.labels[None], permuted_labels(sets, permutations, seed)])
    energy = _between_less_within(distances, labels)
    kernel = _between_less_within(-np.exp(-(distances**2) / (2 * width**2)), labels)
    return _separation(energy), _separation(kernel)


def harmonics_frechet(
    augmented: Array, reference: Array, sets: TwoSets, *, seed: int = 0
) -> Separation | None:
    """The Frechet distance between Gaussians fitted to the harmonic spectra of two sets.

    Spectra are the log2 of the power in degrees 1 to 8 over that of degree 0: 8 numbers that
    no rotation and no exposure changes. With few maps the distance of equal distributions is
    well above 0; `expected` says how far.

    Args:
        augmented: (n, 17) power by degree.
        reference: (m, 17).
        sets: Which maps belong together.
        seed: Of the shuffles.

    Returns:
        None with fewer than 9 maps in a set, whose covariances would be singular.
    """
    spectra = log_spectra(np.concatenate([augmented, reference]))[:, _FRECHET_DEGREES]
    if min(len(augmented), len(reference)) <= spectra.shape[1]:
        return None
    labels = np.concatenate([sets.labels[None], permuted_labels(sets, _FRECHET_SHUFFLES, seed)])
    return _separation(
        np.array([frechet_distance(spectra[chosen], spectra[~chosen]) for chosen in labels])
    )


def log_spectra(power: Array) -> Array:
    """The log2 of power over that of degree 0, (n, 17); what is nothing counts as 2^-40."""
    return np.asarray(np.log2(np.maximum(power / power[:, :1], 2.0**-40)))


def neighborhoods(
    augmented: Array, reference: Array, sets: TwoSets, *, k: int = 5, seed: int = 0
) -> Neighborhood | None:
    """Precision, recall, density and coverage of vectors; None with too few maps.

    Args:
        augmented: (n, d).
        reference: (m, d).
        sets: Which maps belong together: halves of the reference split no group.
        k: Of the k nearest; less in sets that have not so many.
        seed: Of the halves.
    """
    k = min(k, len(augmented) - 1, len(reference) - 1)
    if k < 1:
        return None
    found = _neighborhood(augmented, reference, k)
    return Neighborhood(k=k, **found, expected=_of_halves(reference, sets.reference, k, seed))


def _of_halves(
    reference: Array, groups: NDArray[np.intp], k: int, seed: int
) -> dict[str, float] | None:
    random = np.random.default_rng([seed, 0x68616C66])
    names = np.unique(groups)
    if len(names) < 2 * (k + 1):
        return None
    splits = []
    for _ in range(_SPLITS):
        first = np.isin(groups, random.permutation(names)[: len(names) // 2])
        if min(first.sum(), (~first).sum()) > k:
            splits.append(_neighborhood(reference[first], reference[~first], k))
    if not splits:
        return None
    return {name: float(np.mean([split[name] for split in splits])) for name in splits[0]}


def _neighborhood(augmented: Array, reference: Array, k: int) -> dict[str, float]:
    between = cdist(augmented, reference)
    reach_a = np.sort(cdist(augmented, augmented), axis=1)[:, k]
    reach_r = np.sort(cdist(reference, reference), axis=1)[:, k]
    inside = between <= reach_r
    return {
        "precision": float(inside.any(axis=1).mean()),
        "recall": float((between <= reach_a[:, None]).any(axis=0).mean()),
        "density": float(inside.sum(axis=1).mean() / k),
        "coverage": float(inside.any(axis=0).mean()),
    }


def _between_less_within(matrix: Array, labels: NDArray[np.bool_]) -> Array:
    """2 E d(X, Y) - E d(X, X') - E d(Y, Y') for every row of labels, without self-distances."""
    own = matrix.diagonal()
    chosen, rest = labels.astype(np.float64), (~labels).astype(np.float64)
    to_chosen = chosen @ matrix
    n, m = chosen.sum(axis=1), rest.sum(axis=1)
    within_a = (to_chosen * chosen).sum(axis=1) - chosen @ own
    within_r = ((rest @ matrix) * rest).sum(axis=1) - rest @ own
    between = (to_chosen * rest).sum(axis=1)
    pairs_a, pairs_r = np.maximum(n * (n - 1), 1), np.maximum(m * (m - 1), 1)
    return np.asarray(2 * between / (n * m) - within_a / pairs_a - within_r / pairs_r)


def _separation(values: Array) -> Separation:
    """The first value against all others, which are of shuffled labels."""
    value, shuffled = float(values[0]), values[1:]
    # Distances without bias may be negative, where a relative tolerance has the wrong sign.
    p = p_value(value, shuffled) if value > 0 else float((shuffled >= value).mean())
    return Separation(
        value=value,
        expected=float(shuffled.mean()),
        null=float(np.percentile(shuffled, 95)),
        p=p,
    )

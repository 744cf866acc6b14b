"""Whether a comparison came out as the 2018 thesis said, from scores of the same samples.

For each seed both models are scored on the same test samples. The difference is taken sample by
sample, averaged over seeds, and its interval is a bootstrap over *places*: samples of one place
are alike, and seeds of one model are no new data.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError

_RESAMPLES = 2000
Expected = Literal["first lower", "same"]


class Verdict(StrEnum):
    """What the data says of a statement."""

    REPRODUCED = "reproduced"
    NOT_REPRODUCED = "not reproduced"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """One model against another on one figure.

    Attributes:
        n: Test samples.
        places: Places that they are from.
        seeds: Pairs of trainings.
        mean: Mean of first minus second.
        low: Lower end of its 95 % interval.
        high: Upper end.
        relative: `mean` over the second's mean score.
        verdict: See `Verdict`.
    """

    n: int
    places: int
    seeds: int
    mean: float
    low: float
    high: float
    relative: float
    verdict: Verdict


def compare(
    first: Sequence[Mapping[str, float]],
    second: Sequence[Mapping[str, float]],
    place_of: Mapping[str, str],
    *,
    expected: Expected = "first lower",
    margin: float = 0.02,
    converged: bool = True,
) -> Comparison:
    """Compare two models.

    "first lower" is reproduced where the interval lies below zero, and not reproduced where it
    lies above; "same" is reproduced where the interval lies within `margin` times the second's
    mean score, and not reproduced where it lies outside. In any other case, and where a training
    had not converged, it is undecided.

    Args:
        first: For each seed, sample -> score, lower is better.
        second: As `first`, of the other model; the seeds in the same order.
        place_of: Sample -> its place.
        expected: What the thesis says.
        margin: Of "same".
        converged: Whether all trainings had.

    Raises:
        UsageError: If the seeds or samples do not match.
    """
    if len(first) != len(second) or not first:
        raise UsageError(f"Seeds come in pairs: {len(first)} and {len(second)}.")
    keys = sorted(first[0])
    if any(sorted(scores) != keys for scores in (*first, *second)):
        raise UsageError("Both models are scored on the same samples; these are not.")
    one, other = (
        np.mean([[scores[key] for key in keys] for scores in seeds], axis=0)
        for seeds in (first, second)
    )
    places = np.unique([place_of[key] for key in keys], return_inverse=True)[1]
    difference = one - other
    low, high = place_interval(difference, places)
    scale = float(other.mean())
    return Comparison(
        n=len(keys),
        places=int(places.max()) + 1,
        seeds=len(first),
        mean=float(difference.mean()),
        low=low,
        high=high,
        relative=float(difference.mean()) / scale if scale else 0.0,
        verdict=_verdict(low, high, expected, margin * abs(scale)) if converged
        else Verdict.UNDECIDED,
    )  # fmt: skip


def _verdict(low: float, high: float, expected: Expected, margin: float) -> Verdict:
    if expected == "same":
        if -margin <= low and high <= margin:
            return Verdict.REPRODUCED
        return Verdict.NOT_REPRODUCED if low > margin or high < -margin else Verdict.UNDECIDED
    if high < 0:
        return Verdict.REPRODUCED
    return Verdict.NOT_REPRODUCED if low > 0 else Verdict.UNDECIDED


def place_interval(values: NDArray[np.float64], places: NDArray[np.int64]) -> tuple[float, float]:
    """The 95 % interval of the mean, by drawing places anew.

    Args:
        values: (N,), one for each sample.
        places: (N,), the number of each sample's place, from 0.
    """
    means = resampled_means(values[None], places)[0]
    low, high = np.percentile(means, [2.5, 97.5])
    return float(low), float(high)


def resampled_means(values: NDArray[np.float64], places: NDArray[np.int64]) -> NDArray[np.float64]:
    """Means of several scores over the same draws of places, (scores, draws).

    Args:
        values: (scores, N).
        places: (N,), the number of each sample's place, from 0.
    """
    count = int(places.max()) + 1
    sums = np.stack([np.bincount(places, weights=row, minlength=count) for row in values])
    sizes = np.bincount(places, minlength=count)
    drawn = np.random.default_rng(0).integers(count, size=(_RESAMPLES, count))
    return np.asarray(sums[:, drawn].sum(axis=-1) / sizes[drawn].sum(axis=-1))

"""From one score per scene to a line in a table.

A mean alone hides what heavy-tailed light errors are like, so a summary carries percentiles, a
trimmed mean and an interval. Intervals are percentile bootstraps over scenes (Efron and
Tibshirani 1993, chapter 13): they say how much another set of scenes like these could move the
mean, not how another training run would.
"""

from collections.abc import Iterable
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import trim_mean

from panokit.errors import UsageError

RESAMPLES = 2000
_TRIMMED_SHARE = 0.1
# Drawn resamples at a time, so that 10,000 scenes need no gigabyte of indices.
_DRAWS = 1 << 21


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """Scores of many scenes.

    Attributes:
        n: How many scores are finite; all others are over these.
        missing: How many are not: no light was found, or the PSNR is infinite.
        mean: Arithmetic.
        mean_low: Lower end of the 95 % bootstrap interval of the mean.
        mean_high: Upper end.
        trimmed_mean: Without the lowest and the highest tenth.
        sd: Standard deviation of the sample (n - 1); 0 for one score.
        p5: 5th percentile, and so on.
        p25: See `p5`.
        p50: The median.
        p75: See `p5`.
        p95: See `p5`.
        max: The highest.
    """

    n: int
    missing: int
    mean: float
    mean_low: float
    mean_high: float
    trimmed_mean: float
    sd: float
    p5: float
    p25: float
    p50: float
    p75: float
    p95: float
    max: float

    def to_json(self) -> dict[str, int | float]:
        """A dictionary for `json.dump`."""
        return asdict(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class PairedDifference:
    """How much one method differs from another on the same scenes.

    Attributes:
        n: Scenes with a finite score of both.
        mean: Mean of first minus second.
        mean_low: Lower end of its 95 % bootstrap interval.
        mean_high: Upper end.
        first_lower: Share of scenes where the first scores lower; ties count a half.
    """

    n: int
    mean: float
    mean_low: float
    mean_high: float
    first_lower: float

    @property
    def is_clear(self) -> bool:
        """Whether the interval leaves out zero."""
        return self.mean_low > 0 or self.mean_high < 0


def summarize(
    scores: Iterable[float], *, seed: int = 0, resamples: int = RESAMPLES, level: float = 0.95
) -> Summary:
    """Summarize one score per scene.

    Args:
        scores: In any order; those that are not finite are counted and left out.
        seed: Of the bootstrap: the same seed gives the same interval.
        resamples: How many samples the bootstrap draws.
        level: The share of them in the interval.

    Raises:
        UsageError: If no score is finite.
    """
    values = np.fromiter(scores, np.float64)
    finite = values[np.isfinite(values)]
    if not len(finite):
        raise UsageError(
            f"None of {len(values)} scores is finite, so there is nothing to summarize."
        )
    low, high = bootstrap_interval(finite, seed=seed, resamples=resamples, level=level)
    p5, p25, p50, p75, p95 = (float(p) for p in np.percentile(finite, [5, 25, 50, 75, 95]))
    return Summary(
        n=len(finite),
        missing=len(values) - len(finite),
        mean=float(finite.mean()),
        mean_low=low,
        mean_high=high,
        trimmed_mean=float(trim_mean(finite, _TRIMMED_SHARE)),
        sd=float(finite.std(ddof=1)) if len(finite) > 1 else 0.0,
        p5=p5,
        p25=p25,
        p50=p50,
        p75=p75,
        p95=p95,
        max=float(finite.max()),
    )


def paired_difference(
    first: Iterable[float],
    second: Iterable[float],
    *,
    seed: int = 0,
    resamples: int = RESAMPLES,
    level: float = 0.95,
) -> PairedDifference:
    """Compare two methods scene by scene, which is far sharper than comparing two means.

    Args:
        first: Scores of one method.
        second: Scores of the other, of the same scenes in the same order.
        seed: Of the bootstrap over scenes.
        resamples: How many samples it draws.
        level: The share of them in the interval.

    Raises:
        UsageError: If the lengths differ, or no scene has two finite scores.
    """
    a, b = np.fromiter(first, np.float64), np.fromiter(second, np.float64)
    if len(a) != len(b):
        raise UsageError(f"Paired scores are of the same scenes; there are {len(a)} and {len(b)}.")
    differences = (a - b)[np.isfinite(a) & np.isfinite(b)]
    if not len(differences):
        raise UsageError("No scene has a finite score of both methods.")
    low, high = bootstrap_interval(differences, seed=seed, resamples=resamples, level=level)
    lower = (differences < 0).mean() + 0.5 * (differences == 0).mean()
    return PairedDifference(
        n=len(differences),
        mean=float(differences.mean()),
        mean_low=low,
        mean_high=high,
        first_lower=float(lower),
    )


def bootstrap_interval(
    values: NDArray[np.float64], *, seed: int = 0, resamples: int = RESAMPLES, level: float = 0.95
) -> tuple[float, float]:
    """The percentile bootstrap interval of the mean of (n,) values."""
    if resamples < 1 or not 0 < level < 1:
        raise UsageError(
            f"A bootstrap needs at least 1 resample and a level between 0 and 1, not "
            f"{resamples} and {level}."
        )
    random = np.random.default_rng(seed)
    means = np.empty(resamples)
    at_once = max(_DRAWS // len(values), 1)
    for start in range(0, resamples, at_once):
        count = min(at_once, resamples - start)
        drawn = random.integers(0, len(values), (count, len(values)))
        means[start : start + count] = values[drawn].mean(axis=1)
    low, high = np.percentile(means, [50 - 50 * level, 50 + 50 * level])
    return float(low), float(high)

"""Verdicts: what is clear is said, what is not is undecided."""

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.evaluate.lighting.verdicts import Verdict, compare

KEYS = [f"{n:03d}" for n in range(120)]
PLACE = {key: f"place {n // 6}" for n, key in enumerate(KEYS)}


def scores(mean, seed, spread=0.1):
    rng = np.random.default_rng(seed)
    common = np.random.default_rng(99).normal(1, 0.3, len(KEYS))
    return dict(zip(KEYS, common + mean + rng.normal(0, spread, len(KEYS)), strict=True))


@pytest.mark.parametrize(
    "mean, verdict",
    [(-0.2, Verdict.REPRODUCED), (0.2, Verdict.NOT_REPRODUCED), (0.0, Verdict.UNDECIDED)],
)
def test_lower_is_told_from_higher(mean, verdict):
    first, second = [scores(mean, s) for s in range(3)], [scores(0, 10 + s) for s in range(3)]
    found = compare(first, second, PLACE)
    assert found.verdict is verdict
    assert found.low <= found.mean <= found.high
    assert (found.n, found.places, found.seeds) == (120, 20, 3)


def test_same_needs_an_interval_within_the_margin():
    second = [scores(0, 10 + s, 0.01) for s in range(3)]
    near = compare([scores(0, s, 0.01) for s in range(3)], second, PLACE, expected="same")
    far = compare([scores(0.3, s, 0.01) for s in range(3)], second, PLACE, expected="same")
    noisy = compare([scores(0, 1, 1.0)], [scores(0, 2, 1.0)], PLACE, expected="same")
    assert near.verdict is Verdict.REPRODUCED
    assert far.verdict is Verdict.NOT_REPRODUCED
    assert noisy.verdict is Verdict.UNDECIDED


def test_a_training_that_had_not_converged_counts_for_no_verdict():
    first, second = [scores(-1, 1)], [scores(0, 2)]
    assert compare(first, second, PLACE, converged=False).verdict is Verdict.UNDECIDED


def test_samples_of_one_place_are_no_new_data():
    one_place = dict.fromkeys(KEYS, "only place")
    few = {key: f"place {n % 2}" for n, key in enumerate(KEYS)}
    first, second = [scores(-0.02, 1)], [scores(0, 2)]
    wide = compare(first, second, few)
    assert compare(first, second, one_place).places == 1
    assert wide.places == 2


def test_unlike_samples_or_seeds_are_refused():
    with pytest.raises(UsageError, match="same samples"):
        compare([scores(0, 1)], [{"000": 1.0}], PLACE)
    with pytest.raises(UsageError, match="pairs"):
        compare([scores(0, 1)], [], PLACE)

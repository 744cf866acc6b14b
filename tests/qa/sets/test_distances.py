"""One figure in two sets: zero for equal sets, right for a known shift, honest by chance."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import ks_2samp, wasserstein_distance

from panokit.errors import UsageError
from panokit.qa.sets.distances import robust_scale, shift_between
from panokit.qa.sets.resampling import two_sets


def apart(n, m):
    return two_sets([f"a{i}" for i in range(n)], [f"r{i}" for i in range(m)])


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(-100, 100), min_size=4, max_size=30))
def test_equal_sets_have_no_distance(values):
    found = shift_between(
        values, values, apart(len(values), len(values)), permutations=99, resamples=100
    )
    if found is None:
        assert robust_scale(np.array(values)) == 0
        return
    assert found.shift.value == found.distance.value == found.ks == 0
    assert found.p == found.ks_p == 1
    assert found.spread is None or found.spread.value == 1


def test_distances_are_the_known_ones():
    random = np.random.default_rng(4)
    ours, theirs = random.normal(1, 2, 31), random.normal(0, 1, 45)
    found = shift_between(ours, theirs, apart(31, 45), permutations=99, resamples=100)
    assert found.distance.value == pytest.approx(
        wasserstein_distance(ours, theirs) / found.scale, rel=1e-9
    )
    assert found.ks == pytest.approx(ks_2samp(ours, theirs).statistic)
    assert found.shift.value == pytest.approx((np.median(ours) - np.median(theirs)) / found.scale)
    assert found.outside.value == found.below + found.above


def test_a_shift_is_seen_with_its_size_and_a_small_p():
    random = np.random.default_rng(5)
    theirs = random.normal(0, 1, 60)
    found = shift_between(theirs + 1.35, theirs, apart(60, 60), resamples=300)
    assert found.shift.value == pytest.approx(1.35 / found.scale)
    assert found.shift.low < found.shift.value < found.shift.high and found.shift.is_clear
    assert found.p == pytest.approx(0.001)
    assert found.distance.value > found.distance_null


def test_pairs_show_a_shift_that_is_small_beside_the_spread():
    random = np.random.default_rng(6)
    theirs = random.normal(0, 1, 30)
    ours = theirs + 0.15 + random.normal(0, 0.02, 30)
    names = [f"s{i}" for i in range(30)]
    paired = shift_between(ours, theirs, two_sets(names, names), resamples=200)
    alone = shift_between(ours, theirs, apart(30, 30), resamples=200)
    assert paired.p < 0.01 < 0.3 < alone.p
    assert paired.shift.high - paired.shift.low < 0.5 * (alone.shift.high - alone.shift.low)


def test_p_values_are_uniform_where_nothing_differs():
    random = np.random.default_rng(7)
    found = [
        shift_between(
            random.normal(size=15), random.normal(size=20), apart(15, 20),
            permutations=99, resamples=100, seed=trial,
        ).p
        for trial in range(200)
    ]  # fmt: skip
    assert np.mean(found) == pytest.approx(0.5, abs=0.08)
    assert 0.01 <= np.mean(np.array(found) <= 0.05) <= 0.10
    assert 0.35 <= np.mean(np.array(found) <= 0.5) <= 0.65


def test_the_interval_of_the_shift_covers_the_truth():
    random = np.random.default_rng(8)
    covered = 0
    for trial in range(100):
        found = shift_between(
            random.normal(0.5, 1, 40), random.normal(0, 1, 40), apart(40, 40),
            permutations=99, resamples=200, seed=trial,
        )  # fmt: skip
        covered += found.shift.low <= 0.5 / found.scale <= found.shift.high
    assert covered >= 88


def test_one_value_in_all_maps_is_no_comparison_and_rare_ones_still_are():
    assert shift_between([3.0] * 5, [3.0] * 5, apart(5, 5)) is None
    rare = [0.0] * 9 + [1.0]
    found = shift_between(rare, [0.0] * 10, apart(10, 10), permutations=99, resamples=100)
    assert found.scale > 0 and found.spread is None


def test_what_does_not_fit_is_told():
    with pytest.raises(UsageError, match="5 and 4 values for 5 and 5 maps"):
        shift_between([1.0] * 5, [1.0] * 4, apart(5, 5))
    with pytest.raises(UsageError, match="finite"):
        shift_between([1.0, np.nan], [1.0, 2.0], apart(2, 2))

"""Shuffles and bootstraps keep what belongs together together."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.errors import UsageError
from panokit.qa.sets.resampling import (
    bootstrap_weights,
    false_discovery_rates,
    p_value,
    permuted_labels,
    two_sets,
    weighted_quantiles,
)


def test_pairs_exchange_their_labels_within_the_pair():
    sets = two_sets(["a", "b", "c"], ["c", "a", "b"])
    shuffled = permuted_labels(sets, 200, seed=1)
    for group in range(3):
        here = shuffled[:, sets.pooled == group]
        assert (here.sum(axis=1) == 1).all()
        assert 0.35 < here[:, 0].mean() < 0.65


def test_maps_of_one_place_move_together():
    sets = two_sets(["a", "a", "b", "b"], ["c", "c", "d", "d"])
    shuffled = permuted_labels(sets, 100, seed=2)
    assert (shuffled.sum(axis=1) == 4).all()
    for group in range(4):
        here = shuffled[:, sets.pooled == group]
        assert (here[:, 0] == here[:, 1]).all()
    assert len(np.unique(shuffled, axis=0)) == 6


def test_a_bootstrap_draws_a_scene_alike_in_both_sets():
    sets = two_sets(["a", "b", "c"], ["a", "b", "d", "d"])
    drawn = bootstrap_weights(sets, 500, seed=3)
    assert (drawn[:, 0] == drawn[:, 3]).all() and (drawn[:, 1] == drawn[:, 4]).all()
    assert (drawn[:, :2].sum(axis=1) == 2).all()
    assert (drawn[:, 2] == 1).all()  # the only scene of the augmented set alone
    assert drawn[:, 0].std() > 0


def test_the_same_seed_draws_the_same():
    sets = two_sets(list("abcd"), list("efgh"))
    assert (permuted_labels(sets, 50, 7) == permuted_labels(sets, 50, 7)).all()
    assert (permuted_labels(sets, 50, 7) != permuted_labels(sets, 50, 8)).any()


def test_an_empty_set_is_told():
    with pytest.raises(UsageError, match="one of them is empty"):
        two_sets([], ["a"])


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(-50, 50), min_size=1, max_size=25))
def test_quantiles_are_those_of_repeated_values(values):
    random = np.random.default_rng(len(values))
    ordered = np.sort(np.array(values))
    times = random.integers(0, 3, len(ordered))
    times[random.integers(len(ordered))] = 2
    shares = (0.05, 0.25, 0.5, 0.75, 0.95)
    found = weighted_quantiles(ordered, times[None].astype(float), shares)[0]
    repeated = np.repeat(ordered, times)
    expected = np.quantile(repeated, shares, method="averaged_inverted_cdf")
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_a_p_value_is_never_zero_and_counts_ties():
    shuffled = np.array([1.0, 2.0, 3.0])
    assert p_value(9.0, shuffled) == 0.25
    assert p_value(3.0, shuffled) == 0.5
    assert p_value(0.0, shuffled) == 1.0


def test_false_discovery_rates_are_those_of_benjamini_and_hochberg():
    assert false_discovery_rates([0.01, 0.04, 0.03, 0.5]) == pytest.approx(
        [0.04, 0.16 / 3, 0.16 / 3, 0.5]
    )
    assert false_discovery_rates([]) == []

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.metrics import paired_difference, summarize
from panokit.metrics.statistics import bootstrap_interval


def test_a_summary_by_hand():
    summary = summarize([1, 2, 3, 4, np.nan, 100, np.inf])
    assert (summary.n, summary.missing) == (5, 2)
    assert summary.mean == pytest.approx(22)
    assert summary.p50 == 3
    assert summary.p25 == 2
    assert summary.p5 == pytest.approx(1.2)
    assert summary.max == 100
    # Deviations -21, -20, -19, -18, 78: their squares sum to 7610.
    assert summary.sd == pytest.approx(np.sqrt(7610 / 4))
    assert summary.mean_low < 22 < summary.mean_high
    assert set(summary.to_json()) >= {"n", "p95", "trimmed_mean"}


def test_the_trimmed_mean_forgets_a_tenth_at_each_end():
    assert summarize([*range(1, 10), 1e6]).trimmed_mean == pytest.approx(np.mean(range(2, 10)))


def test_the_interval_of_the_mean_is_that_of_theory():
    values = np.random.default_rng(1).normal(10, 2, 400)
    low, high = bootstrap_interval(values, seed=3)
    # 1.96 * 2 / sqrt(400) on each side.
    assert high - low == pytest.approx(2 * 1.96 * 0.1, rel=0.12)
    assert low < values.mean() < high
    assert bootstrap_interval(values, seed=3) == (low, high)
    wide = bootstrap_interval(values, seed=3, level=0.99)
    assert wide[0] < low < high < wide[1]


def test_drawing_in_parts_changes_nothing_but_memory(monkeypatch):
    values = np.arange(50.0)
    whole = bootstrap_interval(values, resamples=500)
    monkeypatch.setattr("panokit.metrics.statistics._DRAWS", 50 * 7)
    assert bootstrap_interval(values, resamples=500) == pytest.approx(whole)


def test_pairs_show_what_means_hide():
    # Scenes differ by far more than methods do.
    scenes = np.random.default_rng(0).lognormal(2, 1.5, 60)
    better, worse = scenes * 0.95, scenes
    difference = paired_difference(better, worse)
    assert difference.is_clear
    assert difference.mean == pytest.approx(-0.05 * scenes.mean())
    assert difference.first_lower == 1
    alone = summarize(better), summarize(worse)
    assert alone[0].mean_high > alone[1].mean_low  # the intervals of the means overlap


def test_equal_methods_are_not_told_apart():
    scores = [1.0, 2.0, 3.0]
    difference = paired_difference(scores, scores)
    assert not difference.is_clear
    assert difference.first_lower == 0.5


def test_scenes_without_both_scores_are_left_out():
    difference = paired_difference([1, np.nan, 3], [2, 2, np.inf])
    assert (difference.n, difference.mean) == (1, -1)


def test_wrong_arguments_are_refused():
    with pytest.raises(UsageError, match="None of 1 scores"):
        summarize([np.nan])
    with pytest.raises(UsageError, match="3 and 2"):
        paired_difference([1, 2, 3], [1, 2])
    with pytest.raises(UsageError, match="No scene"):
        paired_difference([np.nan], [1])
    with pytest.raises(UsageError, match="resample"):
        bootstrap_interval(np.ones(3), resamples=0)

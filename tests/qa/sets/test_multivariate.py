"""All figures at once: sets of one distribution are not apart, others are."""

import numpy as np
import pytest

from panokit.qa.sets.multivariate import (
    energy_and_kernel,
    harmonics_frechet,
    neighborhoods,
    standardized,
)
from panokit.qa.sets.resampling import two_sets


def apart(n, m):
    return two_sets([f"a{i}" for i in range(n)], [f"r{i}" for i in range(m)])


def test_figures_become_vectors_of_the_reference():
    ours = [{"one": 4.0, "gone": None, "flat": 1.0}, {"one": 400.0, "gone": 2.0, "flat": 1.0}]
    theirs = [{"one": float(v), "gone": 1.0, "flat": 1.0} for v in range(5)]
    a, r, names = standardized(ours, theirs)
    assert names == ("one",)
    assert r[:, 0] == pytest.approx([-1, -0.5, 0, 0.5, 1])
    assert a[:, 0] == pytest.approx([1, 10])  # clipped


def test_one_distribution_is_not_apart_and_two_are():
    random = np.random.default_rng(1)
    theirs = random.normal(size=(60, 5))
    energy, kernel = energy_and_kernel(
        random.normal(size=(30, 5)), theirs, apart(30, 60), permutations=199
    )
    assert energy.p > 0.05 and kernel.p > 0.05
    assert energy.expected == pytest.approx(0, abs=0.03)
    # The same marginals, other combinations: only all figures together can tell.
    mixed = random.normal(size=(60, 5))
    mixed[:] = mixed[:, :1]
    energy, kernel = energy_and_kernel(mixed, theirs, apart(60, 60), permutations=199)
    assert energy.p <= 0.02 and kernel.p <= 0.02
    assert energy.excess > 0


def test_p_values_of_the_energy_distance_are_uniform_where_nothing_differs():
    random = np.random.default_rng(2)
    found = [
        energy_and_kernel(
            random.normal(size=(12, 3)), random.normal(size=(14, 3)), apart(12, 14),
            permutations=99, seed=trial,
        )[0].p
        for trial in range(200)
    ]  # fmt: skip
    assert np.mean(found) == pytest.approx(0.5, abs=0.08)
    assert np.mean(np.array(found) <= 0.05) <= 0.10


def test_the_bias_of_the_frechet_distance_is_told():
    random = np.random.default_rng(3)
    power = np.exp2(random.normal(size=(60, 17)))
    found = harmonics_frechet(power[:30], power[30:], apart(30, 30))
    assert found.value > 1  # far from 0, though there is nothing to find
    assert abs(found.excess) < 0.5 * found.value and found.p > 0.05
    other = power.copy()
    other[:30, 3] *= 8
    assert harmonics_frechet(other[:30], other[30:], apart(30, 30)).p < 0.02
    assert harmonics_frechet(power[:8], power[30:], apart(8, 30)) is None


def test_a_set_of_one_kind_is_precise_and_recalls_little():
    random = np.random.default_rng(4)
    theirs = np.concatenate([random.normal(-5, 1, (40, 3)), random.normal(5, 1, (40, 3))])
    half = random.normal(-5, 1, (40, 3))
    found = neighborhoods(half, theirs, apart(40, 80))
    assert found.precision > 0.9 and 0.35 < found.coverage < 0.6 and found.recall < 0.6
    assert found.expected["coverage"] > 0.9
    away = neighborhoods(half + 100, theirs, apart(40, 80))
    assert away.precision == away.recall == away.density == away.coverage == 0


def test_few_maps_have_fewer_neighbors_and_one_has_none():
    points = np.random.default_rng(5).normal(size=(4, 2))
    assert neighborhoods(points, points, apart(4, 4)).k == 3
    assert neighborhoods(points[:1], points, apart(1, 4)) is None

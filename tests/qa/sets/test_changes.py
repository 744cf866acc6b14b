"""The rule: what is shifted distorts, what is wider adds, what is equal is the same."""

import numpy as np
import pytest

from panokit.qa.sets import DESCRIPTORS, Effect, SetSettings
from panokit.qa.sets.changes import changes_between, distribution_of, effect_of
from panokit.qa.sets.distances import shift_between
from panokit.qa.sets.resampling import two_sets

QUICK = SetSettings(permutations=599, resamples=200)
NAMES = [d.name for d in DESCRIPTORS]


def figures(random, count, **changed):
    """Normal figures for every descriptor; `changed` replaces some by name."""
    columns = {name: random.normal(size=count) for name in NAMES}
    columns |= {name.replace("_", "-"): values for name, values in changed.items()}
    return [{name: column[i] for name, column in columns.items()} for i in range(count)]


def apart(n, m):
    return two_sets([f"a{i}" for i in range(n)], [f"r{i}" for i in range(m)])


def found_by_name(ours, theirs, sets=None, settings=QUICK):
    sets = sets or apart(len(ours), len(theirs))
    return {c.descriptor.name: c for c in changes_between(ours, theirs, sets, settings)}


@pytest.fixture
def random():
    return np.random.default_rng(11)


def test_every_figure_is_judged_and_a_shifted_one_distorts(random):
    ours = figures(random, 60, contrast=random.normal(1.5, 1, 60))
    found = found_by_name(ours, figures(random, 60))
    assert list(found) == NAMES
    assert found["contrast"].effect is Effect.DISTORTS and found["contrast"].reason == "higher"
    others = [c.effect for name, c in found.items() if name != "contrast"]
    assert others.count(Effect.DISTORTS) <= 1


def test_a_lower_one_says_so(random):
    found = found_by_name(figures(random, 60, detail=random.normal(-2, 1, 60)), figures(random, 60))
    assert (found["detail"].effect, found["detail"].reason) == (Effect.DISTORTS, "lower")


def test_lost_variety_distorts_though_the_middle_is_right(random):
    theirs = figures(random, 80, contrast=random.normal(0, 1, 80))
    found = found_by_name(figures(random, 80, contrast=random.normal(0, 0.25, 80)), theirs)
    assert (found["contrast"].effect, found["contrast"].reason) == (Effect.DISTORTS, "narrower")


def test_new_range_around_the_same_middle_adds(random):
    found = found_by_name(
        figures(random, 100, contrast=random.normal(0, 4, 100)), figures(random, 100)
    )
    change = found["contrast"]
    assert (change.effect, change.reason) == (Effect.ADDS, "wider")
    assert change.shift.outside.value > 0.4
    assert min(change.shift.below, change.shift.above) > 0.1


def test_the_same_maps_are_the_same_in_every_figure(random):
    theirs = figures(random, 40)
    names = [f"s{i}" for i in range(40)]
    found = found_by_name(theirs, theirs, two_sets(names, names))
    assert {c.effect for c in found.values()} == {Effect.SAME}
    assert all(c.shift.distance.value == 0 for c in found.values())


def test_few_maps_are_undecided_and_never_the_same():
    random = np.random.default_rng(1000)
    found = found_by_name(figures(random, 5), figures(random, 5))
    assert {c.effect for c in found.values()} == {Effect.UNDECIDED}


def test_no_figure_is_told_apart_where_nothing_differs():
    told = 0
    for seed in range(5):
        random = np.random.default_rng(seed)
        found = found_by_name(figures(random, 25), figures(random, 30))
        told += sum(c.effect in (Effect.DISTORTS, Effect.ADDS) for c in found.values())
    assert told <= 1


def test_maps_without_a_figure_are_counted_and_too_few_are_not_compared(random):
    ours, theirs = figures(random, 20), figures(random, 20)
    for one in ours[3:]:
        one["key-elevation"] = None
    theirs[0]["key-radius"] = None
    found = found_by_name(ours, theirs)
    change = found["key-elevation"]
    assert (change.augmented_count, change.augmented_missing) == (3, 17)
    assert change.effect is Effect.UNDECIDED and change.shift is None
    assert found["key-radius"].reference_missing == 1
    assert found["key-radius"].shift is not None


def test_one_value_in_all_maps_is_the_same(random):
    flat = np.zeros(10)
    found = found_by_name(figures(random, 10, plateau=flat), figures(random, 10, plateau=flat))
    assert found["plateau"].effect is Effect.SAME


def test_the_rule_has_its_numbers_from_the_settings(random):
    shift = shift_between(
        random.normal(0.5, 1, 80), random.normal(0, 1, 80), apart(80, 80), resamples=200
    )
    assert effect_of(shift, 0.001, QUICK)[0] is Effect.DISTORTS
    lax = SetSettings(shift_min=0.9)
    assert effect_of(shift, 0.001, lax)[0] is not Effect.DISTORTS
    assert effect_of(shift, 0.2, QUICK)[0] is Effect.UNDECIDED
    assert effect_of(shift, 0.2, SetSettings(same_within=2))[0] is Effect.SAME


def test_distributions_are_numbers_to_draw():
    found = distribution_of([0.0, 1, 2], [1.0, 1.5, 2, 3, 10])
    assert sum(found.reference_counts) == 5 and sum(found.augmented_counts) == 3
    assert len(found.edges) == len(found.reference_counts) + 1
    assert found.reference_below[-1] == found.augmented_below[-1] == 1
    assert found.augmented_below[0] == pytest.approx(1 / 3) and found.reference_below[0] == 0
    flat = distribution_of([2.0, 2], [2.0])
    assert sum(flat.augmented_counts) == 2


def test_the_same_scenes_have_nothing_to_add(random):
    theirs = figures(random, 60)
    wide = figures(random, 60, contrast=np.array([f["contrast"] for f in theirs]) * 4)
    names = [f"s{i}" for i in range(60)]
    found = found_by_name(wide, theirs, two_sets(names, names))["contrast"]
    assert (found.effect, found.reason) == (Effect.DISTORTS, "wider")


def test_maps_that_are_wrong_each_in_its_own_way_are_seen_beside_their_truth(random):
    theirs = figures(random, 60)
    shuffled = np.array([f["contrast"] for f in theirs])[::-1]
    ours = [{**f, "contrast": c} for f, c in zip(theirs, shuffled, strict=True)]
    names = [f"s{i}" for i in range(60)]
    found = {
        c.descriptor.name: c
        for c in changes_between(ours, theirs, two_sets(names, names), QUICK, list(range(60)))
    }
    assert found["contrast"].effect is Effect.SAME
    assert found["contrast"].own_change.low > 0.3
    assert found["detail"].own_change.value == 0
    assert found_by_name(ours, theirs)["contrast"].own_change is None

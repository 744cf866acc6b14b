"""What of the reference is reached, by kinds."""

import numpy as np
import pytest

from panokit.qa.sets.coverage import coverage_of

# Four scenes in a row, two maps of each; scenes 1 apart, the last 3 away.
REFERENCE = np.array([[0.0], [0.01], [1], [1.01], [2], [2.01], [5], [5.01]])
GROUPS = np.array([0, 0, 1, 1, 2, 2, 3, 3])
KINDS = ["sun", "sun", "sun", "sun", "night", "night", "indoor", "indoor"]


def test_a_scene_is_reached_by_a_map_as_near_as_references_are_to_each_other():
    ours = np.array([[0.3], [4.6]])
    found = coverage_of(ours, REFERENCE, GROUPS, {"light": (["sun", "indoor"], KINDS)})
    # A second map of the same place must not make the radius small.
    assert found.radius == pytest.approx(0.99, abs=0.02)
    assert found.covered == pytest.approx(6 / 8)
    kinds = found.kinds["light"]
    assert (kinds["sun"].reference, kinds["sun"].covered, kinds["sun"].augmented) == (4, 4, 1)
    assert (kinds["night"].covered, kinds["night"].augmented) == (0, 0)
    assert found.share_of_kinds("light") == pytest.approx(2 / 3)


def test_the_reference_covers_itself_and_nothing_far_away_does():
    labels = {"light": (KINDS, KINDS)}
    assert coverage_of(REFERENCE, REFERENCE, GROUPS, labels).covered == 1
    away = coverage_of(REFERENCE + 100, REFERENCE, GROUPS, labels)
    assert away.covered == 0 and away.share_of_kinds("light") == 0


def test_unknown_kinds_are_not_counted():
    found = coverage_of(
        REFERENCE[:1], REFERENCE, GROUPS,
        {"month": ([""], [""] * 8), "cell": (["7"], [""] * 8)},
    )  # fmt: skip
    assert list(found.kinds) == ["cell"]
    assert found.share_of_kinds("cell") is None
    assert found.to_json()["partitions"]["cell"]["kinds"]["7"]["augmented"] == 1


def test_one_scene_has_no_radius():
    assert coverage_of(REFERENCE, REFERENCE, np.zeros(8, int), {}) is None

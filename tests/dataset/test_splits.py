"""No place, probe or object is in two splits, by name or by content."""

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.dataset.settings import DatasetSettings
from panokit.dataset.splits import assign_splits, group_by_shared_keys, split_of_index
from panokit.errors import UsageError

SETTINGS = DatasetSettings(validation_share=0.1, test_share=0.2)


@pytest.mark.parametrize("start", [0, 777, 123_456])
def test_every_run_of_indices_has_the_shares(start):
    found = Counter(split_of_index(SETTINGS, index) for index in range(start, start + 1000))
    assert abs(found["test"] - 200) <= 3
    assert abs(found["validation"] - 100) <= 3


def test_names_with_a_common_key_are_one_group():
    groups = group_by_shared_keys(
        {"a": ["place:1"], "b": ["place:2", "content:x"], "c": ["place:3"], "d": ["content:x"]}
    )
    assert groups["b"] == groups["d"]
    assert len({groups["a"], groups["b"], groups["c"]}) == 3


NAMES = st.text("abcdef", min_size=1, max_size=4)
KEYS = st.lists(st.sampled_from("123456789"), max_size=3)


@given(st.dictionaries(NAMES, KEYS, max_size=12))
def test_groups_are_the_connected_sets(keys):
    groups = group_by_shared_keys(keys)
    for one, mine in keys.items():
        for other, theirs in keys.items():
            if set(mine) & set(theirs):
                assert groups[one] == groups[other]


def test_a_library_that_grows_keeps_its_splits():
    few = [f"place-{n}" for n in range(60)]
    many = [f"place-{n}" for n in range(120)]
    before = assign_splits(few, SETTINGS, "places")
    after = assign_splits(many, SETTINGS, "places")
    assert {name: after[name] for name in few} == before


def test_no_split_is_empty_even_with_three_groups():
    found = assign_splits(["a", "b", "c"], SETTINGS, "places")
    assert set(found.values()) == {"train", "validation", "test"}


def test_too_few_groups_are_refused_with_the_way_out():
    with pytest.raises(UsageError, match="--validation-share"):
        assign_splits(["a", "b"], SETTINGS, "places")


def test_another_seed_splits_otherwise():
    names = [f"place-{n}" for n in range(40)]
    other = SETTINGS.model_copy(update={"seed": 1})
    assert assign_splits(names, SETTINGS, "places") != assign_splits(names, other, "places")

"""A set against a reference, whole: equal sets, dimmed suns, duplicates, broken files."""

import json

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.qa.sets import Effect, SetSettings, compare_sets
from panokit.qa.sets.store import DescriptionStore

QUICK = SetSettings(permutations=599, resamples=200)


@pytest.fixture
def reference(make_set, scenes):
    return make_set("reference", {f"place-{i}": scenes(i) for i in range(16)})


def effects(comparison):
    return {change.descriptor.name: change.effect for change in comparison.changes}


def test_a_set_against_itself_differs_in_nothing(reference):
    found = compare_sets(reference, reference, QUICK)
    assert set(effects(found).values()) == {Effect.SAME}
    assert found.paired == 16
    assert found.energy.p > 0.5
    assert found.coverage.covered == found.neighborhood.recall == 1
    assert found.duplicates == ()  # a map and its own truth are no news
    assert all(one.nearest.own_rank == 1 for one in found.augmented)
    assert all(before == after for before, after in (m.split(" > ") for m in found.class_moves))


def test_clipped_suns_distort_and_what_they_leave_alone_does_not(reference, make_set, scenes):
    clipped = make_set("clipped", {f"place-{i}": np.minimum(scenes(i), 1.2) for i in range(16)})
    found = compare_sets(clipped, reference, QUICK)
    effect = effects(found)
    for name in ("peak-over-median", "top-share", "degree-9-16", "anisotropy"):
        assert effect[name] is Effect.DISTORTS, name
    lowered = {c.descriptor.name: c.reason for c in found.changes}
    assert lowered["peak-over-median"] == "lower"
    assert effect["shadows"] is Effect.SAME
    assert found.energy.p < 0.02


def test_a_shifted_color_is_called_distorted_and_the_rest_is_not(reference, make_set, scenes):
    warm = make_set("warm", {f"place-{i}": scenes(i, warmth=1.5) for i in range(16)})
    effect = effects(compare_sets(warm, reference, QUICK))
    assert effect["ambient-warmth"] is effect["ambient-temperature"] is Effect.DISTORTS
    for name in ("light-elevation", "key-elevation", "lights", "detail"):
        assert effect[name] is Effect.SAME, name


def test_a_copied_reference_under_another_name_is_found(reference, make_set, scenes):
    others = {f"new-{i}": scenes(100 + i) for i in range(5)}
    others["stolen"] = np.roll(scenes(7), 31, axis=1) * 3
    found = compare_sets(make_set("mine", others), reference, QUICK)
    assert [(pair.first, pair.second) for pair in found.duplicates] == [
        ("augmented/stolen", "reference/place-7")
    ]
    stolen = next(one for one in found.augmented if one.member.name == "stolen")
    assert stolen.nearest.by_look == stolen.nearest.by_spectrum == "place-7"


def test_broken_files_are_told_of_and_the_rest_is_compared(reference, make_set, scenes):
    ours = make_set("ours", {f"m{i}": scenes(50 + i) for i in range(5)})
    ours += make_set("dark", {"black": np.zeros((64, 128, 3), np.float32)})
    ours[0].path.write_bytes(b"no picture")
    found = compare_sets(ours, reference, QUICK)
    assert {(one.item, one.reason == "black-map") for one in found.skipped} == {
        ("m0", False),
        ("black", True),
    }
    assert str(ours[0].path.parent) not in json.dumps(found.to_json())
    assert len(found.augmented) == 4


def test_too_few_maps_are_told(reference, make_set, scenes):
    with pytest.raises(UsageError, match="4 readable maps or more"):
        compare_sets(make_set("few", {"a": scenes(1)}), reference, QUICK)


def test_the_record_is_plain_and_the_same_every_time(reference, make_set, scenes, tmp_path):
    ours = make_set("ours", {f"m{i}": scenes(50 + i) for i in range(5)})
    store = DescriptionStore(tmp_path / "kept.jsonl")
    first = compare_sets(ours, reference, QUICK, store=store).to_json()
    second = compare_sets(ours, reference, QUICK, store=DescriptionStore(tmp_path / "kept.jsonl"))
    assert json.dumps(first, allow_nan=False) == json.dumps(second.to_json(), allow_nan=False)
    assert first["counts"] == {
        "augmented": 5, "reference": 16, "paired": 0,
        "tested_augmented": 5, "tested_reference": 16,
    }  # fmt: skip
    assert sum(first["effects"].values()) == len(first["changes"])
    assert str(tmp_path) not in json.dumps(first)


def test_of_large_sets_some_are_drawn_and_all_are_listed(reference):
    small = SetSettings(permutations=99, resamples=100, maps_max=16)
    found = compare_sets(reference, [*reference, *reference[:3]], small)
    assert found.tested == (16, 16) and len(found.reference) == 19

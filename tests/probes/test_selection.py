"""Selecting: even among groups, different within them, the same for the same seed."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.errors import RecordError, UsageError
from panokit.io import write_json
from panokit.probes import SelectSettings, read_selection, select, write_selection
from panokit.probes.descriptors import LENGTH
from panokit.probes.entry import COLUMNS, Entry
from panokit.probes.selection import allot


def entry(number, category="a", place=""):
    values = dict.fromkeys(COLUMNS, "")
    return Entry(**{**values, "id": f"{number:016x}", "name": f"n{number}",
                    "category": category, "place": place})  # fmt: skip


def library_of(counts, seed=0, spread=1.0):
    rng = np.random.default_rng(seed)
    entries, known = [], {}
    for category, count in counts.items():
        for _ in range(count):
            one = entry(len(entries), category)
            entries.append(one)
            known[one.id] = tuple(rng.normal(0, spread, LENGTH))
    return entries, known


def least_distance(ids, known):
    points = np.array([known[id] for id in ids])
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    return gaps[~np.eye(len(ids), dtype=bool)].min()


@settings(deadline=None)
@given(
    available=st.dictionaries(st.text(max_size=3), st.integers(1, 30), min_size=1, max_size=6),
    count=st.integers(1, 60),
)
def test_quotas_are_even_and_add_up(available, count):
    quotas = allot(available, count)
    assert sum(quotas.values()) == min(count, sum(available.values()))
    assert all(0 <= quotas[g] <= available[g] for g in available)
    # No group gets two more than one that still has some to give.
    for group, quota in quotas.items():
        if quota < available[group]:
            assert max(quotas.values()) <= quota + 1


def test_every_category_gets_its_part():
    entries, known = library_of({"day": 50, "night": 5, "indoor": 20})
    chosen = select(entries, known, SelectSettings(count=24))
    counts = Counter(e.category for e in entries if e.id in chosen.ids)
    # Five is all the night there is; the others share what it cannot give.
    assert counts == {"day": 10, "night": 5, "indoor": 9}
    assert chosen.counts["night"] == (5, 5)


def test_what_is_chosen_is_more_different_than_chance():
    entries, known = library_of({"a": 200})
    chosen = select(entries, known, SelectSettings(count=20))
    rng = np.random.default_rng(1)
    ids = [e.id for e in entries]
    by_chance = [least_distance(rng.choice(ids, 20, replace=False), known) for _ in range(50)]
    assert chosen.least_distance == pytest.approx(least_distance(chosen.ids, known), abs=1e-3)
    assert chosen.least_distance > max(by_chance)


def test_near_duplicates_come_last():
    entries, known = library_of({"a": 10})
    for number in range(10, 20):
        one = entry(number)
        entries.append(one)
        known[one.id] = tuple(np.array(known[entries[number - 10].id]) + 1e-3)
    chosen = select(entries, known, SelectSettings(count=10))
    originals = {int(id, 16) % 10 for id in chosen.ids}
    assert originals == set(range(10))


def test_the_first_of_a_selection_are_a_selection():
    entries, known = library_of({"": 60})
    few = select(entries, known, SelectSettings(count=5, seed=3, balance="none"))
    many = select(entries, known, SelectSettings(count=30, seed=3, balance="none"))
    assert many.ids[:5] == few.ids


def test_seeds_and_order():
    entries, known = library_of({"a": 40, "b": 40})
    wanted = SelectSettings(count=10)
    first = select(entries, known, wanted)
    assert select(list(reversed(entries)), known, wanted) == first
    assert select(entries, known, SelectSettings(count=10, seed=1)).ids != first.ids


def test_no_more_than_so_many_of_a_place():
    entries = [entry(number, place=f"place {number % 4}") for number in range(40)]
    _, known = library_of({"": 40})
    chosen = select(entries, known, SelectSettings(count=40, per_place=2))
    places = Counter(e.place for e in entries if e.id in chosen.ids)
    assert set(places.values()) == {2}
    assert len(chosen.ids) == 8


def test_without_descriptors_there_is_still_a_choice():
    entries, _ = library_of({"a": 6})
    assert len(select(entries, {}, SelectSettings(count=3)).ids) == 3


def test_a_selection_is_written_and_read(tmp_path):
    entries, known = library_of({"a": 10, "b": 10})
    chosen = select(entries, known, SelectSettings(count=4, seed=7), {"verdict": "pass"})
    write_selection(chosen, tmp_path / "s.json")
    assert read_selection(tmp_path / "s.json") == chosen
    assert chosen.criteria["seed"] == 7
    assert chosen.criteria["filter"] == {"verdict": "pass"}
    first = (tmp_path / "s.json").read_bytes()
    write_selection(select(entries, known, SelectSettings(count=4, seed=7), {"verdict": "pass"}),
                    tmp_path / "t.json")  # fmt: skip
    assert (tmp_path / "t.json").read_bytes() == first


def test_other_files_are_no_selection(tmp_path):
    write_json(tmp_path / "x.json", {"schema": "other"})
    with pytest.raises(RecordError, match="probes select"):
        read_selection(tmp_path / "x.json")
    write_json(tmp_path / "y.json", {"schema": "panokit.selection/1", "ids": ["a"]})
    with pytest.raises(RecordError, match="damaged"):
        read_selection(tmp_path / "y.json")
    with pytest.raises(RecordError):
        read_selection(tmp_path / "nothing.json")


def test_nothing_to_choose_from():
    with pytest.raises(UsageError, match="nothing to select"):
        select([], {}, SelectSettings(count=3))

"""The maps of a folder, and which of them show one place."""

from dataclasses import replace

import pytest

from panokit.errors import UsageError
from panokit.qa.sets import members_of
from panokit.qa.sets.members import groups_of


def test_a_manifest_gives_categories_and_groups(make_set, scenes, tmp_path):
    make_set("refs", {f"m{i}": scenes(i) for i in range(3)})
    (tmp_path / "refs" / "manifest.csv").write_text(
        "name,file,category,split_group,usable_for\n"
        "first,m0.exr,outdoor+urban,place,training\n"
        "m1,m1.exr,indoor,room,robustness only\n"
    )
    found = members_of(tmp_path / "refs")
    assert [(m.name, m.category, m.group) for m in found] == [
        ("first", "outdoor", "place"),
        ("m2", "", ""),
    ]


def test_a_folder_without_maps_is_told(tmp_path):
    with pytest.raises(UsageError, match="There are no"):
        members_of(tmp_path)


def test_names_groups_and_places_make_one_scene(make_set, scenes, capture):
    ours = make_set("ours", {"a": scenes(1), "b": scenes(2), "c": scenes(3)})
    theirs = make_set("theirs", {"b": scenes(2), "d": scenes(4), "e": scenes(5)})
    ours[0] = replace(ours[0], group="g")
    theirs[1] = replace(theirs[1], group="g")
    ours[2] = replace(ours[2], capture=capture)
    theirs[2] = replace(theirs[2], capture=replace(capture, id="other"))
    sets = groups_of(ours, theirs)
    assert len(sets.shared) == 3
    assert sets.augmented[0] == sets.reference[1]
    assert sets.augmented[1] == sets.reference[0]
    assert sets.augmented[2] == sets.reference[2]
    apart = groups_of(ours[:1], theirs[:1])
    assert len(apart.shared) == 0

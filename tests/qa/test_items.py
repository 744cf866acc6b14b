"""What a path means: a map, a folder of maps, a run."""

from pathlib import Path

import pytest

from panokit.errors import StorageError, UsageError
from panokit.qa import find_items


def touch(folder, *names):
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()


def test_a_run_gives_its_probes_with_the_pictures_on_the_way(tmp_path):
    touch(tmp_path, "run.json", "probes/a.exr", "probes/b.exr", "probes/a.json",
          "panoramas/a.jpg", "panoramas/b.jpg", "filled/a.jpg")  # fmt: skip
    a, b = find_items([tmp_path])
    assert (a.name, a.map_path) == ("a", tmp_path / "probes/a.exr")
    assert a.panorama_path == tmp_path / "panoramas/a.jpg"
    assert a.filled_path == tmp_path / "filled/a.jpg"
    assert b.filled_path is None


def test_a_folder_gives_its_maps_each_once(tmp_path):
    touch(tmp_path, "a.exr", "a.hdr", "b.HDR", "b.jpg", "notes.txt")
    items = find_items([tmp_path])
    assert [(i.name, i.map_path.name) for i in items] == [("a", "a.exr"), ("b", "b.HDR")]
    assert items[1].panorama_path == tmp_path / "b.jpg"


def test_a_file_gives_itself(tmp_path):
    touch(tmp_path, "a.hdr", "b.exr")
    assert [i.name for i in find_items([tmp_path / "b.exr", tmp_path / "a.hdr"])] == ["b", "a"]


def test_a_path_without_maps_says_what_to_do(tmp_path):
    with pytest.raises(UsageError, match="panokit expand"):
        find_items([tmp_path])
    with pytest.raises(UsageError, match="There is no"):
        find_items([tmp_path / "nowhere"])


@pytest.mark.parametrize("refused", ["iterdir", "exists"])
def test_a_folder_that_cannot_be_read_is_told_of_as_an_input(tmp_path, monkeypatch, refused):
    def locked(self):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, refused, locked)
    with pytest.raises(StorageError, match=r"Cannot read .*ermissions") as caught:
        find_items([tmp_path])
    assert "--out" not in str(caught.value)

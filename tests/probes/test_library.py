"""The library: round trip, duplicates, filters, and mending what was interrupted or damaged."""

import json
import os
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from panokit.errors import ImageError, StorageError, UsageError
from panokit.io import read_environment_map, write_environment_map
from panokit.probes import Library, ProbeFilter, probe_id
from panokit.probes.shelf import Shelf
from panokit.qa import Verdict


@pytest.fixture
def library(tmp_path):
    with Library.create(tmp_path / "lib") as made:
        yield made


def folder_of(library, probe):
    return library.folder / "probes" / probe.id


def test_what_is_added_is_found_again_with_its_license_and_its_steps(library, make_map):
    envmap = make_map(1)
    added = library.add(envmap, name="square")
    assert added.is_new
    probe = library.show(added.probe.id)
    assert probe.name == "square"
    assert probe.capture == envmap.capture
    assert probe.license.id == "CC-BY-SA-4.0"
    assert probe.license.attribution == "© A. Mapper"
    assert probe.provenance == envmap.provenance
    assert probe.report.verdict is Verdict.PASS
    assert np.array_equal(library.read(probe.id).radiance, envmap.radiance)
    assert {p.name for p in folder_of(library, probe).iterdir()} == {
        "probe.exr", "probe.json", "preview.jpg",
    }  # fmt: skip
    (entry,) = library.list()
    assert (entry.name, entry.license, entry.attribution) == (
        "square", "CC-BY-SA-4.0", "© A. Mapper",
    )  # fmt: skip
    assert entry.trainable is True


def test_the_map_in_the_library_is_read_with_its_record_by_any_reader(library, make_map):
    envmap = make_map(1)
    probe = library.add(envmap).probe
    found = read_environment_map(folder_of(library, probe) / "probe.exr")
    assert (found.frame, found.anchor, found.capture) == (
        envmap.frame, envmap.anchor, envmap.capture,
    )  # fmt: skip


def test_a_map_is_added_from_a_file_under_the_files_name(library, make_map, tmp_path):
    write_environment_map(make_map(2), tmp_path / "harbor.exr")
    assert library.add(tmp_path / "harbor.exr").probe.name == "harbor"
    assert library.add(make_map(3)).probe.name == "panoramax-picture-3"


def test_a_file_that_is_no_map_is_refused_and_leaves_nothing(library, tmp_path):
    (tmp_path / "broken.exr").write_bytes(b"no map")
    with pytest.raises(ImageError):
        library.add(tmp_path / "broken.exr")
    assert len(library) == 0
    assert list((library.folder / "probes").iterdir()) == []


def test_adding_twice_does_nothing_and_says_so(library, make_map):
    first = library.add(make_map(1), name="first")
    before = (folder_of(library, first.probe) / "probe.json").stat()
    second = library.add(make_map(1), name="second")
    assert not second.is_new
    assert second.probe == first.probe
    assert (folder_of(library, first.probe) / "probe.json").stat() == before
    assert len(library) == 1


def test_two_libraries_of_the_same_maps_are_equal_byte_for_byte(tmp_path, make_map):
    contents = []
    for name in ("a", "b"):
        with Library.create(tmp_path / name) as library:
            library.add(make_map(1))
        shelf = tmp_path / name / "probes"
        contents.append(
            {p.relative_to(shelf): p.read_bytes() for p in shelf.rglob("*") if p.is_file()}
        )
    assert len(contents[0]) == 3
    assert contents[0] == contents[1]


@pytest.mark.parametrize(
    ("wanted", "names"),
    [
        (ProbeFilter(), ["a_night", "b_noon", "c_noon"]),
        (ProbeFilter(name="NOON"), ["b_noon", "c_noon"]),
        (ProbeFilter(name="_"), ["a_night", "b_noon", "c_noon"]),
        (ProbeFilter(name="%"), []),
        (ProbeFilter(place="bristol"), ["a_night", "b_noon"]),
        (ProbeFilter(trainable=False), ["c_noon"]),
        (ProbeFilter(license="cc-by-sa-4.0", name="noon"), ["b_noon"]),
        (ProbeFilter(provider="google-tiles"), []),
        (ProbeFilter(verdict="pass"), ["a_night", "b_noon", "c_noon"]),
        (ProbeFilter(dynamic_range_min_stops=99), []),
    ],
)
def test_lists_are_filtered(library, make_map, wanted, names):
    library.add(make_map(1), name="b_noon")
    library.add(make_map(2), name="a_night")
    library.add(make_map(3, place="Lyon", spdx="someones-own-terms"), name="c_noon")
    assert [entry.name for entry in library.list(wanted)] == names


def test_a_probe_is_shown_by_the_first_digits_of_its_id(library, make_map):
    probe = library.add(make_map(1)).probe
    assert library.show(probe.id[:5]) == probe
    with pytest.raises(UsageError, match=r"no probe 'zz'.*panokit probes list .*lib"):
        library.show("zz")
    with pytest.raises(UsageError, match="no probe ''"):
        library.show("")


def test_digits_that_two_probes_share_are_not_enough(library, make_map):
    ids = [library.add(make_map(seed)).probe.id for seed in range(20)]
    shared = next(i[0] for i in ids if sum(other[0] == i[0] for other in ids) > 1)
    with pytest.raises(UsageError, match="Give more digits"):
        library.show(shared)


def test_the_id_depends_on_light_and_source_and_on_nothing_else(make_map):
    envmap = make_map(1)
    brighter = envmap.with_changes(radiance=envmap.radiance * np.float32(1.001))
    assert probe_id(envmap) == probe_id(make_map(1, place="Lyon"))
    assert len({probe_id(m) for m in (envmap, brighter, envmap.with_changes(capture=None))}) == 3


def test_a_deleted_index_is_made_anew(tmp_path, make_map):
    with Library.create(tmp_path) as library:
        expected = [library.add(make_map(seed)).probe.id for seed in range(3)]
        listed = library.list()
    (tmp_path / "library.sqlite").unlink()
    with Library.open(tmp_path) as library:
        assert library.list() == listed
        assert len(library) == len(expected)


def test_a_damaged_index_is_made_anew(tmp_path, make_map):
    with Library.create(tmp_path) as library:
        library.add(make_map(1))
        listed = library.list()
    (tmp_path / "library.sqlite").write_bytes(b"this is not a database" * 200)
    with Library.open(tmp_path) as library:
        assert library.list() == listed


def test_reindex_follows_folders_that_came_and_went(tmp_path, make_map):
    with Library.create(tmp_path / "other") as other:
        copied = other.add(make_map(9)).probe
    with Library.create(tmp_path / "lib") as library:
        gone = library.add(make_map(1)).probe
        kept = library.add(make_map(2)).probe
        shutil.rmtree(folder_of(library, gone))
        shutil.copytree(
            tmp_path / "other/probes" / copied.id, library.folder / "probes" / copied.id
        )
        assert library.reindex() == 2
        assert {entry.id for entry in library.list()} == {kept.id, copied.id}


def test_opening_looks_into_new_folders_only(tmp_path, make_map, monkeypatch):
    with Library.create(tmp_path / "lib") as library:
        for seed in range(3):
            library.add(make_map(seed))
    looked_at = []
    has = Shelf.has
    monkeypatch.setattr(Shelf, "has", lambda self, id: looked_at.append(id) or has(self, id))
    with Library.open(tmp_path / "lib") as library:
        assert len(library.list()) == 3
    assert looked_at == []
    with Library.create(tmp_path / "other") as other:
        copied = other.add(make_map(9)).probe.id
    looked_at.clear()
    shutil.copytree(tmp_path / "other/probes" / copied, tmp_path / "lib/probes" / copied)
    with Library.open(tmp_path / "lib") as library:
        assert len(library.list()) == 4
    assert looked_at == [copied]


def test_a_probe_is_found_by_its_name_and_a_near_one_is_named(library, make_map):
    probe = library.add(make_map(1), name="old_harbor").probe
    assert library.show("old_harbor") == probe
    with pytest.raises(UsageError, match=rf"Did you mean {probe.id[:10]} \(old_harbor\)\?"):
        library.show("old_habor")
    wrong = ("0" if probe.id[7] != "0" else "1").join([probe.id[:7], probe.id[8:]])
    with pytest.raises(UsageError, match=rf"Did you mean {probe.id[:10]}"):
        library.show(wrong)


def test_an_empty_library_says_how_to_fill_it(library):
    with pytest.raises(UsageError, match=r"is empty\. Add maps with: panokit probes add"):
        library.show("3f9c")


def test_records_of_before_are_read(library, make_map):
    """Without kind, category, tags, sun and descriptor, as they were written first."""
    probe = library.add(make_map(1)).probe
    path = folder_of(library, probe) / "probe.json"
    record = json.loads(path.read_text())
    for name in ("kind", "category", "tags", "sun", "descriptor"):
        del record["probe"][name]
    path.write_text(json.dumps(record))
    old = library.show(probe.id)
    assert (old.kind, old.category, old.descriptor, old.sun) == (
        "lifted", "outdoor_street", (), None,
    )  # fmt: skip
    assert library.reindex() == 1
    assert library.list()[0].kind == "lifted"


KILLED_ADD = """
import os, sys
from pathlib import Path
import panokit.probes.shelf as shelf
from panokit.io import read_environment_map
from panokit.probes import Library

def die(*args, **kwargs):
    os.kill(os.getpid(), 9)

if sys.argv[3] == "index":
    import panokit.probes.index as index
    index.Index.put = die
else:
    setattr(shelf, sys.argv[3], die)
with Library.create(Path(sys.argv[1])) as library:
    library.add(Path(sys.argv[2]))
"""


def killed_add(library: Path, source: Path, where: str) -> int:
    command = [sys.executable, "-c", KILLED_ADD, str(library), str(source), where]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    return subprocess.run(command, env=environment, check=False, timeout=60).returncode


@pytest.mark.parametrize("where", ["write_environment_map", "_preview", "write_json"])
def test_a_kill_while_a_probe_is_written_leaves_no_probe(tmp_path, make_map, where):
    write_environment_map(make_map(1), tmp_path / "map.exr")
    assert killed_add(tmp_path / "lib", tmp_path / "map.exr", where) == -9
    with Library.open(tmp_path / "lib") as library:
        assert library.list() == ()
        found = library.verify()
        assert found.problems == ()
        assert (found.checked, len(found.swept)) == (0, int(where != "write_environment_map"))
        assert list((tmp_path / "lib/probes").iterdir()) == []
        assert library.add(tmp_path / "map.exr").is_new


def test_a_kill_before_the_index_is_written_loses_nothing(tmp_path, make_map):
    write_environment_map(make_map(1), tmp_path / "map.exr")
    assert killed_add(tmp_path / "lib", tmp_path / "map.exr", "index") == -9
    with Library.open(tmp_path / "lib") as library:
        assert len(library.list()) == 1
        assert library.verify().problems == ()


def test_a_folder_without_a_record_is_no_probe_and_is_swept(library, make_map):
    probe = library.add(make_map(1)).probe
    (folder_of(library, probe) / "probe.json").unlink()
    assert library.reindex() == 0
    assert not folder_of(library, probe).exists()


def test_a_folder_that_somebody_else_filled_is_reported_and_left_alone(library):
    foreign = library.folder / "probes" / "notes"
    foreign.mkdir()
    (foreign / "todo.txt").write_text("buy film")
    found = library.verify()
    assert [(p.folder, p.reason) for p in found.problems] == [("notes", "no-record")]
    assert (foreign / "todo.txt").exists()


def test_a_full_disk_leaves_no_probe(library, make_map, monkeypatch):
    def full(*args, **kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("panokit.probes.shelf.write_bytes", full)
    with pytest.raises(StorageError, match="disk is full"):
        library.add(make_map(1))
    assert list((library.folder / "probes").iterdir()) == []


@pytest.mark.parametrize("name", ["probe.exr", "preview.jpg"])
def test_verify_finds_one_changed_byte(library, make_map, name):
    probe = library.add(make_map(1)).probe
    library.add(make_map(2))
    assert library.verify().problems == ()
    path = folder_of(library, probe) / name
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    (problem,) = library.verify().problems
    assert (problem.folder, problem.reason) == (probe.id, "changed-on-disk")
    assert name in problem.message


def test_verify_finds_a_missing_file_and_a_damaged_record(library, make_map):
    without, damaged = (library.add(make_map(seed)).probe for seed in (1, 2))
    (folder_of(library, without) / "preview.jpg").unlink()
    (folder_of(library, damaged) / "probe.json").write_text("{")
    found = library.verify()
    assert {(p.folder, p.reason) for p in found.problems} == {
        (without.id, "missing-file"), (damaged.id, "damaged-record"),
    }  # fmt: skip
    assert library.reindex() == 1


def test_verify_finds_a_probe_under_a_wrong_id(library, make_map):
    probe = library.add(make_map(1)).probe
    wrong = "0" * 16
    folder_of(library, probe).rename(library.folder / "probes" / wrong)
    (problem,) = library.verify().problems
    assert (problem.folder, problem.reason) == (wrong, "wrong-id")


def test_opening_a_folder_that_is_no_library_says_how_to_make_one(tmp_path):
    with pytest.raises(UsageError, match="probes add"):
        Library.open(tmp_path)


def as_it_lies(folder):
    return {p: (p.stat().st_mtime_ns, p.stat().st_size) for p in sorted(folder.rglob("*"))}


def test_a_library_whose_index_cannot_be_written_is_read_all_the_same(tmp_path, make_map):
    with Library.create(tmp_path) as library:
        probe = library.add(make_map(1)).probe
        listed = library.list()
    (tmp_path / "library.sqlite").unlink()
    # Nobody, not even root, can open a folder as a database.
    (tmp_path / "library.sqlite").mkdir()
    before = as_it_lies(tmp_path)
    with Library.open(tmp_path) as library:
        assert library.list() == listed
        assert library.show(probe.id[:6]) == probe
        assert library.verify().problems == ()
        with pytest.raises(StorageError, match=r"Cannot write the index .*permissions"):
            library.reindex()
    assert as_it_lies(tmp_path) == before
    with pytest.raises(StorageError, match=r"Cannot write the index .*permissions"):
        Library.create(tmp_path)


@pytest.mark.unprivileged
def test_a_library_without_write_permission_is_read(tmp_path, make_map):
    with Library.create(tmp_path / "lib") as library:
        library.add(make_map(1))
        listed = library.list()
    folders = [tmp_path / "lib", *(p for p in (tmp_path / "lib").rglob("*"))]
    for path in folders:
        path.chmod(0o555 if path.is_dir() else 0o444)
    try:
        with Library.open(tmp_path / "lib") as library:
            assert library.list() == listed
    finally:
        for path in folders:
            path.chmod(0o755 if path.is_dir() else 0o644)


def test_a_library_that_cannot_be_read_says_so(tmp_path, monkeypatch):
    def locked(self):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "is_dir", locked)
    with pytest.raises(StorageError, match=r"Cannot read .*ermissions") as caught:
        Library.open(tmp_path)
    assert "--out" not in str(caught.value)


@pytest.mark.parametrize(
    ("code", "free", "is_full"),
    [
        (sqlite3.SQLITE_FULL, 1 << 30, True),
        (sqlite3.SQLITE_IOERR_SHMSIZE, 0, True),
        (sqlite3.SQLITE_IOERR_WRITE, 1 << 30, False),
    ],
)
def test_a_full_disk_under_the_index_is_told_as_one(tmp_path, monkeypatch, code, free, is_full):
    def fail(self):
        error = sqlite3.OperationalError("disk I/O error")
        error.sqlite_errorcode = code
        raise error

    monkeypatch.setattr("panokit.probes.index.Index._opened", fail)
    monkeypatch.setattr(
        "panokit.probes.index.shutil.disk_usage", lambda path: SimpleNamespace(free=free)
    )
    with pytest.raises(StorageError) as caught:
        Library.create(tmp_path)
    assert ("the disk is full. Free some space" in str(caught.value)) is is_full
    assert ("may be deleted" in str(caught.value)) is not is_full

"""Maps that stay where they are: referenced with their digests, not copied."""

import shutil

import numpy as np
import pytest

from panokit.errors import RecordError, StorageError
from panokit.io import read_environment_map, write_environment_map, write_exr
from panokit.probes import Library, ProbeFilter


@pytest.fixture
def hdri(tmp_path, make_map):
    path = tmp_path / "hdris" / "harbor.hdr"
    path.parent.mkdir()
    write_environment_map(make_map(1), path)
    return path


def add(library, path):
    return library.add(read_environment_map(path), name=path.stem, in_place=path).probe


def test_nothing_is_copied_and_the_map_is_found(tmp_path, hdri):
    before = hdri.read_bytes()
    with Library.create(tmp_path / "lib") as library:
        probe = add(library, hdri)
        assert {p.name for p in (tmp_path / "lib/probes" / probe.id).iterdir()} == {
            "probe.json", "preview.jpg",
        }  # fmt: skip
        assert library.map_path(probe.id) == hdri
        expected = read_environment_map(hdri)
        found = library.read(probe.id)
        assert np.array_equal(found.radiance, expected.radiance)
        assert (found.capture, found.frame) == (expected.capture, expected.frame)
        assert library.verify().problems == ()
        assert library.list()[0].in_place
    assert hdri.read_bytes() == before


def test_the_library_and_its_maps_may_move_together(tmp_path, hdri):
    with Library.create(tmp_path / "lib") as library:
        probe = add(library, hdri)
    moved = tmp_path / "elsewhere"
    moved.mkdir()
    shutil.move(tmp_path / "lib", moved / "lib")
    shutil.move(tmp_path / "hdris", moved / "hdris")
    with Library.open(moved / "lib") as library:
        assert library.map_path(probe.id) == moved / "hdris" / "harbor.hdr"
        assert library.verify().problems == ()


def test_a_file_that_changed_is_told_with_what_to_do(tmp_path, hdri, make_map):
    with Library.create(tmp_path / "lib") as library:
        probe = add(library, hdri)
        write_environment_map(make_map(2), hdri)
        (problem,) = library.verify().problems
        assert (problem.folder, problem.reason) == (probe.id, "changed-on-disk")
        assert "harbor" in problem.message
        assert f"probes/{probe.id}" in problem.message
        with pytest.raises(RecordError, match="has changed since it was added"):
            library.read(probe.id)


def test_a_file_that_is_gone_is_told_with_what_to_do(tmp_path, hdri):
    with Library.create(tmp_path / "lib") as library:
        probe = add(library, hdri)
        hdri.unlink()
        (problem,) = library.verify().problems
        assert problem.reason == "missing-file"
        with pytest.raises(StorageError, match="Put it back where it was"):
            library.read(probe.id)
        # It is listed all the same.
        assert library.show(probe.id).name == "harbor"


def test_a_stored_map_that_changed_is_not_read(tmp_path, make_map):
    with Library.create(tmp_path / "lib") as library:
        probe = library.add(make_map(1)).probe
        write_exr(library.map_path(probe.id), make_map(2).radiance)
        with pytest.raises(RecordError, match="changed since it was added"):
            library.read(probe.id)


def test_the_same_map_is_one_probe_however_it_is_added(tmp_path, hdri):
    with Library.create(tmp_path / "lib") as library:
        probe = add(library, hdri)
        again = library.add(hdri)
        assert not again.is_new
        assert again.probe.id == probe.id
        assert library.list(ProbeFilter(name="harbor"))[0].id == probe.id


def test_an_index_is_rebuilt_from_records_in_place_too(tmp_path, hdri):
    with Library.create(tmp_path / "lib") as library:
        add(library, hdri)
        listed = library.list()
        assert library.reindex() == 1
        assert library.list() == listed

import errno
import os

import pytest

from panokit.errors import RecordError, StorageError
from panokit.io.files import (
    atomic_write,
    file_entry,
    read_bytes,
    read_json,
    sha256_of_bytes,
    sha256_of_file,
    write_bytes,
    write_json,
)


def test_a_file_is_whole_or_not_there(tmp_path):
    path = tmp_path / "deep" / "a.bin"
    write_bytes(path, b"one")
    with pytest.raises(RuntimeError), atomic_write(path) as part:
        part.write_bytes(b"half")
        raise RuntimeError("killed")
    assert path.read_bytes() == b"one"
    assert [p.name for p in path.parent.iterdir()] == ["a.bin"]


def test_a_full_disk_is_said_and_leaves_nothing(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StorageError, match="disk is full: free some space"):
        write_bytes(tmp_path / "a.bin", b"x")
    assert list(tmp_path.iterdir()) == []


def test_written_files_have_ordinary_permissions(tmp_path):
    write_bytes(tmp_path / "a", b"x")
    (tmp_path / "b").write_bytes(b"x")
    assert (tmp_path / "a").stat().st_mode == (tmp_path / "b").stat().st_mode


def test_json_has_the_same_bytes_for_equal_values(tmp_path):
    write_json(tmp_path / "a.json", {"b": 1, "a": "é"})
    write_json(tmp_path / "b.json", {"a": "é", "b": 1})
    assert read_bytes(tmp_path / "a.json") == read_bytes(tmp_path / "b.json")
    assert read_json(tmp_path / "a.json") == {"a": "é", "b": 1}
    with pytest.raises(ValueError, match="JSON"):
        write_json(tmp_path / "c.json", {"a": float("nan")})
    assert not (tmp_path / "c.json").exists()


def test_missing_and_damaged_records_are_told_apart(tmp_path):
    with pytest.raises(RecordError) as caught:
        read_json(tmp_path / "a.json")
    assert caught.value.reason == "no-record"
    (tmp_path / "a.json").write_bytes(b'{"a": ')
    with pytest.raises(RecordError) as caught:
        read_json(tmp_path / "a.json")
    assert caught.value.reason == "damaged-record"


def test_a_folder_in_the_way_is_a_storage_error(tmp_path):
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(StorageError):
        write_bytes(tmp_path / "file" / "a.bin", b"x")
    with pytest.raises(StorageError, match="Check the path"):
        read_bytes(tmp_path / "nothing")


def test_digests(tmp_path):
    write_bytes(tmp_path / "a", b"abc")
    digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert sha256_of_bytes(b"abc") == sha256_of_file(tmp_path / "a") == digest
    assert file_entry(tmp_path / "a") == {"bytes": 3, "sha256": digest}

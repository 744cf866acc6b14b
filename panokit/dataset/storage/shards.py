"""Shards: tar files of samples in WebDataset naming, the same bytes for the same samples.

A member of sample 000000012 is called 000000012.left.png: what comes before the first dot is
the sample's key. Every tar program reads a shard, and since nothing in it depends on a clock,
a user or a machine, equal samples make equal shards.
"""

import tarfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from panokit.errors import RecordError
from panokit.io.files import atomic_write, storage_error

BLOCK = tarfile.BLOCKSIZE
_END = bytes(2 * BLOCK)


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """Where a member of a sample lies in its shard.

    Attributes:
        key: Of the sample.
        name: Of the member: "left.png".
        offset: Of its first byte in the file.
        bytes: How many there are.
    """

    key: str
    name: str
    offset: int
    bytes: int


def tar_bytes(key: str, members: Mapping[str, bytes]) -> bytes:
    """The part of a tar file that holds one sample.

    Args:
        key: Of the sample.
        members: Name -> content, in the order in which they are written.
    """
    return b"".join(_entry(f"{key}.{name}", data) for name, data in members.items())


def _entry(name: str, data: bytes) -> bytes:
    header = tarfile.TarInfo(name)
    header.size = len(data)
    header.mode = 0o644
    # Time, owner and group of a new TarInfo are 0 and empty; they stay so.
    return header.tobuf(tarfile.USTAR_FORMAT) + data + bytes(-len(data) % BLOCK)


def write_shard(path: Path, parts: Iterable[bytes]) -> None:
    """Write a shard atomically.

    Args:
        path: Of the shard.
        parts: What `tar_bytes` gave for each sample, in order.

    Raises:
        StorageError: If the disk is full or the folder cannot be written.
    """
    with atomic_write(path) as part, part.open("wb") as file:
        for data in parts:
            file.write(data)
        file.write(_END)


def read_members(path: Path) -> Iterator[Member]:
    """Where each member lies, in the order of the file; contents are not read.

    Raises:
        RecordError: If the file is no whole tar, or holds anything but samples' files.
        StorageError: If it cannot be read.
    """
    try:
        with tarfile.open(path, "r:") as file:
            for entry in file:
                key, dot, name = entry.name.partition(".")
                if not entry.isfile() or not dot or "/" in entry.name:
                    raise RecordError(
                        f"{path} holds {entry.name!r}, which is no file of a sample. Render the "
                        "shard again.",
                        reason="damaged-shard",
                    )
                yield Member(key=key, name=name, offset=entry.offset_data, bytes=entry.size)
            _check_end(path, file.offset)
    except tarfile.TarError as error:
        raise _damaged(path, str(error)) from error
    except OSError as error:
        raise storage_error("read", path, error) from error


def _check_end(path: Path, offset: int) -> None:
    """A tar ends with two empty blocks; Python's reader does not miss them."""
    with path.open("rb") as file:
        file.seek(-len(_END), 2)
        if file.read() != _END:
            raise _damaged(path, f"it ends too early, after {offset} bytes")


def _damaged(path: Path, why: str) -> RecordError:
    return RecordError(
        f"The shard {path} is damaged ({why}). Delete it and run the same command again.",
        reason="damaged-shard",
    )

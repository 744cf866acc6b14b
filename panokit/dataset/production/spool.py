"""Finished samples of an unfinished shard, one file each, so that a kill costs one sample.

A file is a line of JSON and the sample's part of the tar. It is not synced to the disk, which
would cost more than it saves; so what a crash of the machine left is told by its digest.
"""

import json
import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
from typing import Any

from panokit.dataset.storage.shards import BLOCK, read_members
from panokit.io.files import sha256_of_bytes, storage_error

_SUFFIX = ".sample"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finished:
    """What became of one sample.

    Attributes:
        key: Its key.
        data: Its part of the tar; empty if it could not be made.
        missing: Why it could not be made, or "".
        rejected: Reason -> how many attempts were rejected for it.
    """

    key: str
    data: bytes
    missing: str = ""
    rejected: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Spool:
    """The folder of such files, for one dataset.

    Attributes:
        folder: It is made when first needed.
        dataset_key: Files of another dataset are not taken for one's own.
    """

    folder: Path
    dataset_key: str

    def put(self, sample: Finished) -> None:
        """Keep a sample.

        Raises:
            StorageError: If the disk is full or cannot be written.
        """
        header = {
            "dataset": self.dataset_key,
            "sha256": sha256_of_bytes(sample.data),
            "missing": sample.missing,
            "rejected": dict(sample.rejected),
        }
        path = self._path(sample.key)
        part = path.with_name(f".{path.name}.{os.getpid()}.part")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            try:
                part.write_bytes(json.dumps(header).encode() + b"\n" + sample.data)
                part.replace(path)
            finally:
                part.unlink(missing_ok=True)
        except OSError as error:
            raise storage_error("write", path, error) from error

    def get(self, key: str) -> Finished | None:
        """A sample that was kept whole, or None.

        Raises:
            StorageError: If there is one that cannot be read.
        """
        path = self._path(key)
        try:
            content = path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise storage_error("read", path, error) from error
        line, _, data = content.partition(b"\n")
        try:
            header = json.loads(line)
            whole = header["sha256"] == sha256_of_bytes(data)
            if not whole or header["dataset"] != self.dataset_key:
                return None
            return Finished(
                key=key, data=data, missing=header["missing"], rejected=header["rejected"]
            )
        except (ValueError, KeyError, TypeError):
            return None

    def unpack(self, shard: Path, record: Mapping[str, Any]) -> None:
        """Keep the samples of a shard that is to be written anew, larger or with fewer gaps.

        Samples that could not be made are left out: they get a new chance.

        Raises:
            RecordError: If the shard is damaged.
            StorageError: If something cannot be read or written.
        """
        for key, members in groupby(read_members(shard), key=lambda member: member.key):
            # Members are blocks one after the other; each has a block of header before it.
            spans = [(member.offset, member.bytes) for member in members]
            first, (last, size) = spans[0][0] - BLOCK, spans[-1]
            end = last + size + -size % BLOCK
            try:
                with shard.open("rb") as file:
                    file.seek(first)
                    data = file.read(end - first)
            except OSError as error:
                raise storage_error("read", shard, error) from error
            self.put(Finished(key=key, data=data, rejected=record["rejected"].get(key, {})))

    def drop(self, keys: Iterable[str]) -> None:
        """Forget samples: their shard is written."""
        for key in keys:
            self._path(key).unlink(missing_ok=True)

    def kept(self) -> list[str]:
        """The samples that are kept."""
        return sorted(path.stem for path in self.folder.glob(f"*{_SUFFIX}"))

    def sweep(self) -> None:
        """Delete what a killed process left half-written."""
        for part in self.folder.glob(f".*{_SUFFIX}.*.part"):
            with suppress(OSError):
                part.unlink()

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}{_SUFFIX}"

"""Whether a dataset is whole: every byte, every file of every sample, and the splits."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from panokit.console import Console
from panokit.dataset.production.description import read_description
from panokit.dataset.sample import SCHEMA
from panokit.dataset.storage.decode import decode_member
from panokit.dataset.storage.index import BYTES, OFFSET, read_index
from panokit.dataset.storage.layout import DatasetFolder
from panokit.dataset.storage.member_table import ALWAYS
from panokit.dataset.storage.sample_checks import check_member, check_views
from panokit.dataset.storage.shards import Member, read_members
from panokit.errors import ItemError, PanokitError
from panokit.io.files import read_json, sha256_of_file

# Columns whose values must not be in two splits: names, and digests of contents.
DISJOINT = {
    "place": "place",
    "probe": "map",
    "probe_sha256": "content of a map",
    "object": "object",
    "object_sha256": "content of an object",
}

_Row = Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """Something that is wrong.

    Attributes:
        place: A shard, a member of it, or a file.
        reason: A short stable code.
        message: One line for a person.
    """

    place: str
    reason: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """What `verify_dataset` found.

    Attributes:
        samples: How many were read.
        shards: How many were read.
        missing: How many samples were asked for and are not there.
        problems: What is wrong; empty if all is well.
    """

    samples: int
    shards: int
    missing: int
    problems: tuple[Problem, ...]


def verify_dataset(folder: Path, console: Console | None = None) -> Verification:
    """Read all of a dataset again.

    Checked are the digest of every shard, that every file of every sample decodes and is what
    the table of members says (size, finite, unit normals, depth where there is an object, ...),
    that the index says where each file lies and what its sample's meta.json says, and that no
    place and no object is in two splits, by name and by content.

    Raises:
        StorageError: If there is no dataset.
        RecordError: If its index cannot be read at all.
    """
    place = DatasetFolder(Path(folder))
    console = console or Console(quiet=True)
    asked = int(read_description(place.root)["count"])
    table = read_index(place.root)
    shards = sorted(place.shards.glob("*.tar"))
    problems: list[Problem] = []
    seen: Counter[str] = Counter()
    with console.stage("verify", len(shards)) as tick:
        for shard in shards:
            part = table.filter(pc.equal(table.column("shard"), shard.name))
            rows = {row["key"]: row for row in part.to_pylist()}
            found = list(_check_shard(shard, rows, seen))
            problems += found
            tick(rejected=bool(found))
    problems += [
        Problem(place=key, reason="twice", message=f"The sample {key} is in {n} places.")
        for key, n in seen.items()
        if n > 1
    ]
    problems += [
        Problem(
            place=key,
            reason="not-in-shards",
            message=f"The index has the sample {key}; no shard has. Render again to mend it.",
        )
        for key in table.column("key").to_pylist()
        if key not in seen
    ]
    problems += check_splits(table)
    return Verification(
        samples=len(seen),
        shards=len(shards),
        missing=asked - len(seen),
        problems=tuple(problems),
    )


def check_splits(table: pa.Table) -> list[Problem]:
    """What is in two splits and must not be."""
    problems = []
    for column, what in DISJOINT.items():
        splits: dict[str, set[str]] = defaultdict(set)
        values = table.column(column).to_pylist()
        for value, split in zip(values, table.column("split").to_pylist(), strict=True):
            if value:
                splits[value].add(split)
        problems += [
            Problem(
                place=str(value),
                reason="split-overlap",
                message=f"The {what} {value} is in {' and '.join(sorted(found))}.",
            )
            for value, found in sorted(splits.items())
            if len(found) > 1
        ]
    return problems


def _check_shard(shard: Path, rows: Mapping[str, _Row], seen: Counter[str]) -> Iterator[Problem]:
    record_path = shard.with_suffix(".json")
    if not record_path.exists():
        yield Problem(place=shard.name, reason="no-record", message="It was not finished.")
        return
    try:
        expected = read_json(record_path)["files"][shard.name]["sha256"]
        if sha256_of_file(shard) != expected:
            yield Problem(
                place=shard.name,
                reason="digest",
                message="Its content is not what was written. Delete it and render again.",
            )
        with shard.open("rb") as file:
            for key, group in groupby(read_members(shard), key=lambda member: member.key):
                seen[key] += 1
                members = {member.name: member for member in group}
                row = rows.get(key)
                if row is None:
                    message = "The index has it not, or elsewhere. Render again to mend it."
                    yield Problem(
                        place=f"{shard.name}/{key}", reason="not-indexed", message=message
                    )
                    row = {}
                yield from _Sample(shard.name, key, members, row).check(file)
    except (PanokitError, OSError, KeyError, TypeError) as error:
        reason = error.reason if isinstance(error, ItemError) else "unreadable"
        yield Problem(place=shard.name, reason=reason, message=str(error))


class _Sample:
    """One sample of a shard, and what the index says of it."""

    def __init__(self, shard: str, key: str, members: Mapping[str, Member], row: _Row) -> None:
        self.shard, self.key, self.members, self.row = shard, key, members, row
        self.values: dict[str, Any] = {}

    def problem(self, name: str, reason: str, message: str) -> Problem:
        """Something that is wrong with one of its members."""
        return Problem(place=f"{self.shard}/{self.key}.{name}", reason=reason, message=message)

    def check(self, file: Any) -> Iterator[Problem]:
        """Read and check all of it."""
        for name in ALWAYS:
            if name not in self.members:
                yield self.problem(name, "no-member", "It is not there.")
        yield from self._check_index()
        yield from self._decode(file)
        meta = self.values.get("meta.json")
        if not isinstance(meta, dict):
            return
        if meta.get("schema") != SCHEMA or meta.get("key") != self.key:
            message = f"It speaks of sample {meta.get('key')}."
            yield self.problem("meta.json", "other-sample", message)
            return
        split = self.shard.rpartition("-")[0]
        if meta.get("split") != split or (self.row and self.row["split"] != split):
            message = f"The sample is of {meta.get('split')}, not of {split}."
            yield self.problem("meta.json", "split", message)
        for name, value in self.values.items():
            for reason, message in check_member(name, value, _width_px(meta)):
                yield self.problem(name, reason, message)
        for name, reason, message in check_views(self.values):
            yield self.problem(name, reason, message)

    def _check_index(self) -> Iterator[Problem]:
        if not self.row:
            return
        for name in {n.removeprefix(OFFSET) for n in self.row if n.startswith(OFFSET)}:
            member = self.members.get(name)
            found = (member.offset, member.bytes) if member else (None, None)
            if (self.row[OFFSET + name], self.row[BYTES + name]) != found:
                message = "The index has it elsewhere. Delete index.parquet and render again."
                yield self.problem(name, "index-offset", message)
        for name in self.members:
            if OFFSET + name not in self.row:
                yield self.problem(name, "index-offset", "The index does not have it.")

    def _decode(self, file: Any) -> Iterator[Problem]:
        for name, member in self.members.items():
            file.seek(member.offset)
            try:
                self.values[name] = decode_member(name, file.read(member.bytes))
            except ItemError as error:
                yield self.problem(name, error.reason, str(error))


def _width_px(meta: Mapping[str, Any]) -> int:
    try:
        return int(meta["views"]["left"]["width_px"])
    except (KeyError, TypeError, ValueError):
        return 0

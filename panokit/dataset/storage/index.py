"""The index of a dataset: one row for each sample, with where each of its members lies."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from panokit.dataset.storage.decode import decode_exr, decode_member
from panokit.dataset.storage.index_columns import FROM_META, OWN, light_direction, row_from_meta
from panokit.dataset.storage.layout import DatasetFolder
from panokit.dataset.storage.member_table import in_order
from panokit.dataset.storage.shards import Member, read_members
from panokit.errors import RecordError, StorageError
from panokit.frames import Rotation
from panokit.io.files import atomic_write, read_json, storage_error
from panokit.provenance import digest_of

SCHEMA = "panokit.dataset-index/1"
OFFSET, BYTES = "offset/", "bytes/"
META, TARGET = "meta.json", "env64.exr"


def index_shards(shards: Sequence[Path], digest: str = "") -> pa.Table:
    """The index of some shards, read from the tar files alone.

    Args:
        shards: The tar files, in the order in which they are to come.
        digest: What `shards_digest` says of them; `indexed_digest` then gives it back.

    Raises:
        RecordError: If a shard or a record in it is damaged.
        StorageError: If one cannot be read.
    """
    # One shard's rows at a time: as Python objects all of them would take too much memory.
    tables = [_table(list(shard_rows(shard))) for shard in shards] or [_table([])]
    whole = pa.concat_tables(tables, promote_options="default")
    columns = [*OWN, *FROM_META]
    for name in in_order(member_names(whole)):
        columns += [OFFSET + name, BYTES + name]
    metadata = {"panokit.schema": SCHEMA, "panokit.shards": digest}
    return whole.select(columns).combine_chunks().replace_schema_metadata(metadata)


def _table(rows: Sequence[Mapping[str, Any]]) -> pa.Table:
    members = sorted({name for row in rows for name in row if name.startswith((OFFSET, BYTES))})
    fields = [
        *OWN.items(),
        *((name, kind) for name, (kind, _) in FROM_META.items()),
        *((name, pa.int64()) for name in members),
    ]
    return pa.Table.from_pylist(list(rows), schema=pa.schema(fields))


def shards_digest(shards: Sequence[Path]) -> str:
    """A digest of shards by their records."""
    return digest_of([[path.name, read_json(path.with_suffix(".json"))] for path in shards])


def indexed_digest(folder: Path) -> str:
    """The `shards_digest` of the shards that the index of a folder is of; "" if it is no index."""
    try:
        schema = pq.read_schema(DatasetFolder(folder).index)
    except (OSError, pa.ArrowException):
        return ""
    found = schema.metadata or {}
    is_ours = found.get(b"panokit.schema") == SCHEMA.encode()
    return found.get(b"panokit.shards", b"").decode() if is_ours else ""


def shard_rows(shard: Path) -> Iterable[dict[str, Any]]:
    """The rows of one shard, in its order."""
    try:
        with shard.open("rb") as file:
            for key, group in groupby(read_members(shard), key=lambda member: member.key):
                members = {member.name: member for member in group}
                yield _row(shard, key, members, lambda m: _content(file, m))
    except OSError as error:
        if isinstance(error, StorageError):
            raise
        raise storage_error("read", shard, error) from error


def _content(file: Any, member: Member) -> bytes:
    file.seek(member.offset)
    return bytes(file.read(member.bytes))


def _row(shard: Path, key: str, members: Mapping[str, Member], read: Any) -> dict[str, Any]:
    if META not in members:
        raise RecordError(f"{shard} has no {META} of sample {key}. Render it again.")
    meta = decode_member(f"{shard}/{key}.{META}", read(members[META]))
    try:
        row = row_from_meta(meta) | {"shard": shard.name}
        if TARGET in members:
            target = decode_exr(read(members[TARGET]), f"{shard}/{key}.{TARGET}")
            world_from_left = Rotation(meta["views"]["left"]["world_from_camera"])
            row |= light_direction(target, world_from_left)
    except (KeyError, TypeError) as error:
        raise RecordError(
            f"{shard}/{key}.{META} is not the record of a sample ({error!r}).",
            reason="damaged-record",
        ) from error
    if row["key"] != key:
        raise RecordError(f"{shard}: {key}.{META} speaks of sample {row['key']}.")
    for name, member in members.items():
        row[OFFSET + name], row[BYTES + name] = member.offset, member.bytes
    return row


def write_index(table: pa.Table, path: Path) -> None:
    """Write an index atomically.

    Raises:
        StorageError: If it cannot be written.
    """
    with atomic_write(path) as part:
        pq.write_table(table, part, compression="zstd")


def read_index(folder: Path, columns: Sequence[str] | None = None) -> pa.Table:
    """The index of the dataset in a folder.

    Args:
        folder: Of the dataset.
        columns: Only these, if given.

    Raises:
        StorageError: If there is none, because nothing was rendered there yet, or it cannot
            be read.
        RecordError: If it is damaged or of another version.
    """
    path = DatasetFolder(Path(folder)).index
    try:
        schema = pq.read_schema(path)
        if (schema.metadata or {}).get(b"panokit.schema") != SCHEMA.encode():
            raise RecordError(
                f"{path} is no index of this version of panokit. Delete it and run "
                "`panokit dataset render` again: it makes a new one.",
                reason="other-schema",
            )
        return pq.read_table(path, columns=list(columns) if columns is not None else None)
    except FileNotFoundError as error:
        raise StorageError(
            f"There is no dataset in {folder}: no {path.name}. Make one with `panokit dataset "
            "render`; one that was interrupted gets its index when it is finished."
        ) from error
    except pa.ArrowException as error:
        raise RecordError(
            f"{path} is damaged ({error}). Delete it and run `panokit dataset render` again: it "
            "makes a new one.",
            reason="damaged-index",
        ) from error
    except OSError as error:
        raise storage_error("read", path, error) from error


def member_names(table: pa.Table) -> tuple[str, ...]:
    """The members that samples of an index have."""
    return tuple(
        name.removeprefix(OFFSET) for name in table.column_names if name.startswith(OFFSET)
    )

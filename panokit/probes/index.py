"""library.sqlite: what `list` looks at. Everything in it is in the records too."""

import shutil
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from panokit.errors import StorageError
from panokit.io.files import storage_error
from panokit.probes.probe import Probe

# Raise it when the columns change: an index of another layout is made anew.
_LAYOUT = 1
_BUSY_TIMEOUT_S = 10.0
IN_MEMORY = Path(":memory:")
# SQLite tells a full disk as a failed write as often as not; less than this is full.
_FULL_BELOW_BYTES = 1 << 20
_FULL_OR_BROKEN = (sqlite3.SQLITE_IOERR, sqlite3.SQLITE_CANTOPEN)
_NOT_WRITABLE = (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM)


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One line of the library's list; each field is a column of the index.

    Attributes:
        id: Of the probe.
        name: What it was called when it was added.
        place: The city or area, "" for none.
        provider: Of the picture, "" for none.
        license: Its id, "unknown" where it is not known.
        attribution: The line to show with the map.
        trainable: Whether the license lets models be trained with it.
        verdict: Of QA: "pass" or "fail".
        width_px: Of the map.
        dynamic_range_stops: From the median to the peak, or None.
        top_share: The share of the energy in the brightest 0.1 % of the sphere, or None.
    """

    id: str
    name: str
    place: str
    provider: str
    license: str
    attribution: str
    trainable: bool
    verdict: str
    width_px: int
    dynamic_range_stops: float | None
    top_share: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeFilter:
    """Which probes to list; a field that is None lets all pass.

    Attributes:
        name: A part of the name, in any case.
        place: The city or area, in any case.
        provider: Of the picture.
        license: Its id.
        trainable: Whether the license lets models be trained.
        verdict: "pass" or "fail".
        dynamic_range_min_stops: The least dynamic range.
    """

    name: str | None = None
    place: str | None = None
    provider: str | None = None
    license: str | None = None
    trainable: bool | None = None
    verdict: str | None = None
    dynamic_range_min_stops: float | None = None


_COLUMNS = tuple(field.name for field in fields(Entry))
_CONDITIONS = {
    "name": "name LIKE '%' || ? || '%' ESCAPE '\\'",
    "place": "place = ? COLLATE NOCASE",
    "provider": "provider = ?",
    "license": "license = ? COLLATE NOCASE",
    "trainable": "trainable = ?",
    "verdict": "verdict = ?",
    "dynamic_range_min_stops": "dynamic_range_stops >= ?",
}


def entry_of(probe: Probe) -> Entry:
    """The line of a probe in the list."""
    values = probe.report.values
    capture = probe.capture
    return Entry(
        id=probe.id,
        name=probe.name,
        place=capture.place if capture else "",
        provider=capture.provider if capture else "",
        license=probe.license.id,
        attribution=probe.license.attribution,
        trainable=probe.license.train,
        verdict=str(probe.report.verdict),
        width_px=probe.width_px,
        dynamic_range_stops=values.get("dynamic-range"),
        top_share=values.get("top-share"),
    )


class Index:
    """The table of entries. Only one process writes; others may read meanwhile (WAL).

    Args:
        path: The file, or IN_MEMORY for a table that is gone when it is closed.

    Raises:
        StorageError: If the file cannot be used, here and in every method.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._connection = self._connect()

    def close(self) -> None:
        """Close the file."""
        self._connection.close()

    def ids(self) -> set[str]:
        """Every probe in the index."""
        with self._reported():
            return {row[0] for row in self._connection.execute("SELECT id FROM probes")}

    def put(self, entries: Iterable[Entry]) -> None:
        """Add entries, or replace those of the same id, all or none."""
        marks = ", ".join("?" for _ in _COLUMNS)
        rows = [tuple(getattr(entry, name) for name in _COLUMNS) for entry in entries]
        with self._reported(), self._connection:
            self._connection.executemany(
                f"INSERT OR REPLACE INTO probes ({', '.join(_COLUMNS)}) VALUES ({marks})", rows
            )

    def remove(self, ids: Iterable[str]) -> None:
        """Take entries out."""
        with self._reported(), self._connection:
            self._connection.executemany("DELETE FROM probes WHERE id = ?", [(i,) for i in ids])

    def find(self, wanted: ProbeFilter) -> tuple[Entry, ...]:
        """The entries that a filter lets pass, by name."""
        conditions, values = ["1"], []
        for name, condition in _CONDITIONS.items():
            value = getattr(wanted, name)
            if value is not None:
                conditions.append(condition)
                values.append(_escaped(value) if name == "name" else value)
        query = (
            f"SELECT {', '.join(_COLUMNS)} FROM probes "
            f"WHERE {' AND '.join(conditions)} ORDER BY name, id"
        )
        with self._reported():
            return tuple(_entry(row) for row in self._connection.execute(query, values))

    def with_prefix(self, prefix: str) -> tuple[str, ...]:
        """The ids that begin with `prefix`, in order."""
        with self._reported():
            rows = self._connection.execute(
                "SELECT id FROM probes WHERE substr(id, 1, ?) = ? ORDER BY id",
                (len(prefix), prefix),
            )
            return tuple(row[0] for row in rows)

    def _connect(self) -> sqlite3.Connection:
        try:
            return self._opened()
        except sqlite3.DatabaseError as error:
            if isinstance(error, sqlite3.OperationalError):
                raise self._storage_error(error) from error
            # Not a database, or a damaged one: nothing is lost, it is made from the records.
            for suffix in ("", "-wal", "-shm"):
                file = self._path.with_name(self._path.name + suffix)
                try:
                    file.unlink(missing_ok=True)
                except OSError as refusal:
                    raise storage_error("delete the damaged", file, refusal) from refusal
            with self._reported():
                return self._opened()

    def _opened(self) -> sqlite3.Connection:
        connection = sqlite3.connect(self._path, timeout=_BUSY_TIMEOUT_S)
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            layout = connection.execute("PRAGMA user_version").fetchone()[0]
            if layout != _LAYOUT:
                with connection:
                    connection.execute("DROP TABLE IF EXISTS probes")
                    connection.execute(f"CREATE TABLE probes ({', '.join(_COLUMNS)})")
                    connection.execute("CREATE UNIQUE INDEX probes_by_id ON probes (id)")
                    connection.execute(f"PRAGMA user_version = {_LAYOUT}")
        except sqlite3.Error:
            connection.close()
            raise
        return connection

    @contextmanager
    def _reported(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise self._storage_error(error) from error

    def _storage_error(self, error: sqlite3.Error) -> StorageError:
        # The low byte is the kind; the rest tells at which step it happened.
        kind = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if kind == sqlite3.SQLITE_FULL or (kind in _FULL_OR_BROKEN and self._disk_is_full()):
            return StorageError(
                f"Cannot write the index {self._path}: the disk is full. "
                "Free some space and run the same command again."
            )
        if kind in _NOT_WRITABLE:
            return StorageError(
                f"Cannot write the index {self._path}: {error}. "
                "Check the permissions of the file and of its folder."
            )
        return StorageError(
            f"Cannot use the index {self._path}: {error}. Check the disk; "
            "the file may be deleted, it is made anew from the records."
        )

    def _disk_is_full(self) -> bool:
        try:
            return shutil.disk_usage(self._path.parent).free < _FULL_BELOW_BYTES
        except OSError:
            return False


def _entry(row: tuple[Any, ...]) -> Entry:
    values = dict(zip(_COLUMNS, row, strict=True))
    return Entry(**{**values, "trainable": bool(values["trainable"])})


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace("%", "\\%").replace("_", "\\_")

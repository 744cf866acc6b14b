"""library.sqlite: what `list` looks at. Everything in it is in the records too."""

import json
import shutil
import sqlite3
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from panokit.errors import StorageError
from panokit.io.files import storage_error
from panokit.probes.entry import COLUMNS, Entry, entry_from_row, query_of
from panokit.probes.settings import ProbeFilter

# Raise it when the columns change: an index of another layout is made anew.
_LAYOUT = 4
_BUSY_TIMEOUT_S = 10.0
IN_MEMORY = Path(":memory:")
# SQLite tells a full disk as a failed write as often as not; less than this is full.
_FULL_BELOW_BYTES = 1 << 20
_FULL_OR_BROKEN = (sqlite3.SQLITE_IOERR, sqlite3.SQLITE_CANTOPEN)
_NOT_WRITABLE = (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM)
# SQLite takes no more values than this in one statement, in builds of any age.
_MOST_VALUES = 900


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

    def put(self, entries: Iterable[tuple[Entry, Sequence[float]]]) -> None:
        """Add entries with their descriptors, or replace those of the same id, all or none."""
        marks = ", ".join("?" for _ in COLUMNS)
        rows, known = [], []
        for entry, descriptor in entries:
            rows.append(tuple(getattr(entry, name) for name in COLUMNS))
            known.append((entry.id, json.dumps(list(descriptor))))
        with self._reported(), self._connection:
            self._connection.executemany(
                f"INSERT OR REPLACE INTO probes ({', '.join(COLUMNS)}) VALUES ({marks})", rows
            )
            self._connection.executemany("INSERT OR REPLACE INTO descriptors VALUES (?, ?)", known)

    def remove(self, ids: Iterable[str]) -> None:
        """Take entries out."""
        gone = [(id,) for id in ids]
        with self._reported(), self._connection:
            self._connection.executemany("DELETE FROM probes WHERE id = ?", gone)
            self._connection.executemany("DELETE FROM descriptors WHERE id = ?", gone)

    def find(self, wanted: ProbeFilter) -> tuple[Entry, ...]:
        """The entries that a filter lets pass, by name."""
        condition, values = query_of(wanted)
        query = f"SELECT {', '.join(COLUMNS)} FROM probes WHERE {condition} ORDER BY name, id"
        with self._reported():
            return tuple(map(entry_from_row, self._connection.execute(query, values)))

    def entries(self, ids: Sequence[str]) -> tuple[Entry, ...]:
        """The entries of these ids, in this order; those that are not there are left out."""
        found: dict[str, Entry] = {}
        with self._reported():
            for start in range(0, len(ids), _MOST_VALUES):
                part = list(ids[start : start + _MOST_VALUES])
                marks = ", ".join("?" for _ in part)
                query = f"SELECT {', '.join(COLUMNS)} FROM probes WHERE id IN ({marks})"
                for row in self._connection.execute(query, part):
                    entry = entry_from_row(row)
                    found[entry.id] = entry
        return tuple(found[id] for id in ids if id in found)

    def descriptors(self) -> dict[str, tuple[float, ...]]:
        """Id -> descriptor of every probe; () where it is not known."""
        with self._reported():
            rows = self._connection.execute("SELECT id, numbers FROM descriptors").fetchall()
        return {id: tuple(json.loads(numbers)) for id, numbers in rows}

    def with_prefix(self, prefix: str) -> tuple[str, ...]:
        """The ids that begin with `prefix`, in order."""
        with self._reported():
            rows = self._connection.execute(
                "SELECT id FROM probes WHERE substr(id, 1, ?) = ? ORDER BY id",
                (len(prefix), prefix),
            )
            return tuple(row[0] for row in rows)

    def named(self, name: str) -> tuple[str, ...]:
        """The ids of the probes that are called so, in order."""
        with self._reported():
            rows = self._connection.execute(
                "SELECT id FROM probes WHERE name = ? ORDER BY id", (name,)
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
                    connection.execute("DROP TABLE IF EXISTS descriptors")
                    # Kept by name, as they are listed, so that listing needs no sorting.
                    connection.execute(
                        f"CREATE TABLE probes ({', '.join(COLUMNS)}, PRIMARY KEY (name, id)) "
                        "WITHOUT ROWID"
                    )
                    connection.execute("CREATE UNIQUE INDEX probes_by_id ON probes (id)")
                    connection.execute("CREATE TABLE descriptors (id PRIMARY KEY, numbers)")
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

"""Verdicts about items, in one SQLite file that only the process driving the run writes.

Only a verdict about the *item* belongs here (no imagery, retired, not a sphere, rejected by a
stage). A condition of the *run* (a key refused, a quota used up, a disk full) does not: a
later run must try those items again.
"""

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from panokit.errors import Rejection, StorageError

_SCHEMA = """
CREATE TABLE IF NOT EXISTS rejections (
    item TEXT NOT NULL,
    stage TEXT NOT NULL,
    key TEXT NOT NULL,
    reason TEXT NOT NULL,
    message TEXT NOT NULL,
    vals TEXT NOT NULL,
    PRIMARY KEY (item, stage)
)
"""


class Ledger:
    """The rejections of a run, by item and stage.

    Args:
        path: The SQLite file; it is made when first needed.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def add(self, rejection: Rejection, key: str = "") -> None:
        """Remember a rejection; `key` tells what was tried, so that other settings try again."""
        with self._connection() as connection:
            connection.execute(
                "INSERT OR REPLACE INTO rejections VALUES (?, ?, ?, ?, ?, ?)",
                (
                    rejection.item,
                    rejection.stage,
                    key,
                    rejection.reason,
                    rejection.message,
                    json.dumps(dict(rejection.values), sort_keys=True, default=str),
                ),
            )

    def remove(self, item: str, stage: str) -> None:
        """Forget a rejection, because the item went through."""
        if self._path.exists():
            with self._connection() as connection:
                connection.execute(
                    "DELETE FROM rejections WHERE item = ? AND stage = ?", (item, stage)
                )

    def clear(self) -> None:
        """Forget every rejection: the next run tries all items again."""
        if self._path.exists():
            with self._connection() as connection:
                connection.execute("DELETE FROM rejections")

    def find(self, item: str, stage: str, key: str) -> Rejection | None:
        """The verdict that this item got at this stage with this key, if it got one."""
        found = self._select("WHERE item = ? AND stage = ? AND key = ?", (item, stage, key))
        return found[0] if found else None

    def rejections(self, stage: str | None = None) -> list[Rejection]:
        """All rejections, of one stage if given, in a stable order."""
        return self._select("WHERE stage = ?", (stage,)) if stage else self._select("", ())

    def _select(self, where: str, values: tuple[str, ...]) -> list[Rejection]:
        if not self._path.exists():
            return []
        with self._connection() as connection:
            rows = connection.execute(
                f"SELECT item, stage, reason, message, vals FROM rejections {where} "
                "ORDER BY item, stage",
                values,
            ).fetchall()
        return [
            Rejection(item=i, stage=s, reason=r, message=m, values=json.loads(v))
            for i, s, r, m, v in rows
        ]

    @contextmanager
    def _connection(self) -> Iterator[sqlite3.Connection]:
        try:
            with closing(sqlite3.connect(self._path)) as connection, connection:
                connection.execute(_SCHEMA)
                yield connection
        except sqlite3.Error as error:
            raise StorageError(
                f"Cannot use the ledger {self._path}: {error}. If it is damaged, delete it: "
                "items that were rejected are then tried again."
            ) from error

"""What is done and what was rejected, in one SQLite file that only a run's driver writes.

The records beside the outputs are what counts; this is an index of them, for looks from outside
while a run goes on, and a memory of verdicts. Only a verdict about the *item* belongs here (no
imagery, retired, not a sphere, rejected by a stage). A condition of the *run* (a key refused, a
quota used up, a disk full) does not: a later run must try those items again.

It can be deleted at any time: `rebuild` makes it anew from the log, and a run from the records.
"""

import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

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
);
CREATE TABLE IF NOT EXISTS done (
    item TEXT NOT NULL,
    stage TEXT NOT NULL,
    key TEXT NOT NULL,
    seconds REAL NOT NULL,
    cpu_s REAL NOT NULL,
    PRIMARY KEY (item, stage)
);
CREATE TABLE IF NOT EXISTS pace (
    stage TEXT PRIMARY KEY,
    wanted INTEGER NOT NULL,
    fresh INTEGER NOT NULL,
    seconds REAL NOT NULL
);
"""
# A reader waits so long for a writer, and the other way round.
_PATIENCE_S = 30.0


class DoneItem(Protocol):
    """An item that a stage is done with; a `Receipt` is one."""

    @property
    def item(self) -> str:
        """The id of the item."""
        ...

    @property
    def stage(self) -> str:
        """The stage."""
        ...

    @property
    def key(self) -> str:
        """What it was made from and with."""
        ...

    @property
    def seconds(self) -> float:
        """How long that took."""
        ...

    @property
    def cpu_s(self) -> float:
        """Processor time that it took."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """How fast a stage went when it last had something to do.

    Attributes:
        wanted: Items that it had before it.
        fresh: How many of them have come out, rejected ones too.
        seconds: In how much time.
    """

    wanted: int
    fresh: int
    seconds: float


class Ledger:
    """Outcomes of a run, by item and stage.

    Args:
        path: The SQLite file; it is made when first needed.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    @property
    def exists(self) -> bool:
        """Whether there is one yet."""
        return self._path.exists()

    def add(self, rejection: Rejection, key: str = "") -> None:
        """Remember a rejection; `key` tells what was tried, so that other settings try again."""
        with self._connection() as connection:
            self._add(connection, rejection, key)

    def add_done(self, receipt: DoneItem) -> None:
        """Remember an item that is done; it is no longer rejected."""
        with self._connection() as connection:
            self._add_done(connection, receipt)

    def clear(self) -> None:
        """Forget every rejection: the next run tries all items again."""
        if self.exists:
            with self._connection() as connection:
                connection.execute("DELETE FROM rejections")

    def settle(
        self,
        stage: str,
        done: Iterable[DoneItem],
        rejections: Iterable[Rejection],
        *,
        key: str = "",
    ) -> None:
        """Let a stage have these outcomes and no others; what is known of them already stays.

        Args:
            stage: The stage.
            done: Its items that are done.
            rejections: Those that were rejected.
            key: What was tried, for rejections that are new.
        """
        wanted = {one.item: one for one in done}
        refused = {one.item: one for one in rejections}
        with self._connection() as connection:
            keys = dict(connection.execute("SELECT item, key FROM done WHERE stage = ?", (stage,)))
            known = {
                item
                for (item,) in connection.execute(
                    "SELECT item FROM rejections WHERE stage = ?", (stage,)
                )
            }
            for table, gone in (
                ("done", keys.keys() - wanted),
                ("rejections", known - refused.keys()),
            ):
                for item in gone:
                    connection.execute(
                        f"DELETE FROM {table} WHERE item = ? AND stage = ?", (item, stage)
                    )
            for item, one in wanted.items():
                if keys.get(item) != one.key:
                    self._add_done(connection, one)
            for item in refused.keys() - known:
                self._add(connection, refused[item], key)

    def set_pace(self, stage: str, pace: Pace) -> None:
        """Remember how fast a stage goes."""
        with self._connection() as connection:
            connection.execute(
                "INSERT OR REPLACE INTO pace VALUES (?, ?, ?, ?)",
                (stage, pace.wanted, pace.fresh, round(pace.seconds, 3)),
            )

    def paces(self) -> dict[str, Pace]:
        """Stage -> how fast it went."""
        rows = self._rows("SELECT stage, wanted, fresh, seconds FROM pace", ())
        return {s: Pace(wanted=w, fresh=f, seconds=t) for s, w, f, t in rows}

    def find(self, item: str, stage: str, key: str) -> Rejection | None:
        """The verdict that this item got at this stage with this key, if it got one."""
        found = self._select("WHERE item = ? AND stage = ? AND key = ?", (item, stage, key))
        return found[0] if found else None

    def rejections(self, stage: str | None = None) -> list[Rejection]:
        """All rejections, of one stage if given, in a stable order."""
        return self._select("WHERE stage = ?", (stage,)) if stage else self._select("", ())

    def counts(self) -> dict[str, tuple[int, float, float]]:
        """Stage -> items done, and the seconds and processor seconds that they took."""
        rows = self._rows(
            "SELECT stage, COUNT(*), SUM(seconds), SUM(cpu_s) FROM done GROUP BY stage", ()
        )
        return {stage: (count, seconds, cpu_s) for stage, count, seconds, cpu_s in rows}

    def content(self) -> list[tuple[str, str, str, str]]:
        """Item, stage, key and outcome of everything, in order: what two ledgers agree on."""
        done = self._rows("SELECT item, stage, key, 'done' FROM done", ())
        rejected = self._rows("SELECT item, stage, key, reason FROM rejections", ())
        return sorted((*done, *rejected))

    def rebuild(self, events: Iterable[Mapping[str, Any]]) -> None:
        """Fill an empty ledger from the lines of a log.

        Args:
            events: As `RunFolder.events` gives them.
        """
        with self._connection() as connection:
            for event in events:
                match event:
                    case {"event": "done", "item": str(), "stage": str(), "key": str()}:
                        seconds = float(event.get("seconds", 0)), float(event.get("cpu_s", 0))
                        row = (event["item"], event["stage"], event["key"], *seconds)
                        connection.execute("INSERT OR REPLACE INTO done VALUES (?,?,?,?,?)", row)
                        self._forget(connection, event["item"], event["stage"])
                    case {"event": "rejected", "item": str(), "stage": str(), "reason": str()}:
                        names = ("item", "stage", "reason", "message", "values")
                        rejection = Rejection(**{n: event[n] for n in names if n in event})
                        self._add(connection, rejection, str(event.get("key", "")))
                    case {"event": "forget-rejections"}:
                        connection.execute("DELETE FROM rejections")

    @staticmethod
    def _add(connection: sqlite3.Connection, rejection: Rejection, key: str) -> None:
        values = json.dumps(dict(rejection.values), sort_keys=True, default=str)
        connection.execute(
            "DELETE FROM done WHERE item = ? AND stage = ?", (rejection.item, rejection.stage)
        )
        connection.execute(
            "INSERT OR REPLACE INTO rejections VALUES (?, ?, ?, ?, ?, ?)",
            (rejection.item, rejection.stage, key, rejection.reason, rejection.message, values),
        )

    def _add_done(self, connection: sqlite3.Connection, receipt: DoneItem) -> None:
        connection.execute(
            "INSERT OR REPLACE INTO done VALUES (?, ?, ?, ?, ?)",
            (receipt.item, receipt.stage, receipt.key, round(receipt.seconds, 3),
             round(receipt.cpu_s, 3)),
        )  # fmt: skip
        self._forget(connection, receipt.item, receipt.stage)

    @staticmethod
    def _forget(connection: sqlite3.Connection, item: str, stage: str) -> None:
        connection.execute("DELETE FROM rejections WHERE item = ? AND stage = ?", (item, stage))

    def _select(self, where: str, values: tuple[str, ...]) -> list[Rejection]:
        rows = self._rows(
            f"SELECT item, stage, reason, message, vals FROM rejections {where} "
            "ORDER BY item, stage",
            values,
        )
        return [
            Rejection(item=i, stage=s, reason=r, message=m, values=json.loads(v))
            for i, s, r, m, v in rows
        ]

    def _rows(self, query: str, values: tuple[str, ...]) -> list[Any]:
        if not self.exists:
            return []
        with self._connection() as connection:
            return connection.execute(query, values).fetchall()

    @contextmanager
    def _connection(self) -> Iterator[sqlite3.Connection]:
        try:
            with (
                closing(sqlite3.connect(self._path, timeout=_PATIENCE_S)) as connection,
                connection,
            ):
                # It can be rebuilt: waiting for the disk at every item is not worth it.
                connection.execute("PRAGMA synchronous = OFF")
                connection.executescript(_SCHEMA)
                yield connection
        except sqlite3.Error as error:
            raise StorageError(
                f"Cannot use the ledger {self._path}: {error}. If it is damaged, delete it: "
                "the next run makes it anew."
            ) from error

"""What is done: keys, receipts, and where everything lies in a run folder.

An output is complete when its record NAME.json exists, carries the key that the stage would
give it now, and its files have the sizes that the record says. Nothing else is asked, so a
run that was killed at any moment goes on where it stopped.
"""

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from panokit.errors import RecordError, StorageError
from panokit.io.files import read_json, storage_error, write_bytes, write_json
from panokit.io.pictures import record_path
from panokit.provenance import digest_of


def stage_key(
    stage: str,
    version: str,
    settings_digest: str,
    inputs: Sequence[str],
    weights_digest: str = "",
) -> str:
    """The name of a result: equal keys promise equal bytes.

    Args:
        stage: The verb.
        version: The stage's own version.
        settings_digest: Of the stage's settings.
        inputs: SHA-256 of each input, in order.
        weights_digest: SHA-256 of the network's weights, if there are any.
    """
    return digest_of([stage, version, settings_digest, list(inputs), weights_digest])


@dataclass(frozen=True, slots=True, kw_only=True)
class Receipt:
    """One item that a stage is done with.

    Attributes:
        item: The id of the item.
        stage: The stage.
        path: Its main output.
        key: What it was made from and with.
        fresh: Whether it was made now, not found complete.
        seconds: How long that took.
        cpu_s: Processor time that it took.
        values: Figures of the step worth showing.
    """

    item: str
    stage: str
    path: Path
    key: str
    fresh: bool = True
    seconds: float = 0.0
    cpu_s: float = 0.0
    values: Mapping[str, Any] = field(default_factory=dict)


def is_complete(path: Path, key: str) -> bool:
    """Whether an output exists, whole and made with this key."""
    record = record_path(path)
    if not record.exists():
        return False
    try:
        value = read_json(record)
    except RecordError:
        return False
    return isinstance(value, dict) and value.get("key") == key and _files_are_whole(path, value)


def _files_are_whole(path: Path, record: Mapping[str, Any]) -> bool:
    for name, entry in record.get("files", {}).items():
        file = path.parent / name
        if not file.is_file() or file.stat().st_size != entry["bytes"]:
            return False
    return path.name in record.get("files", {})


@dataclass(frozen=True, slots=True)
class RunFolder:
    """Where everything of one run lies.

    Attributes:
        root: The folder.
    """

    root: Path

    @property
    def captures(self) -> Path:
        """One folder per capture, as it was fetched."""
        return self.root / "captures"

    @property
    def panoramas(self) -> Path:
        """Stitched and leveled panoramas."""
        return self.root / "panoramas"

    @property
    def filled(self) -> Path:
        """Panoramas without holes."""
        return self.root / "filled"

    @property
    def probes(self) -> Path:
        """HDR environment maps."""
        return self.root / "probes"

    @property
    def qa(self) -> Path:
        """The report."""
        return self.root / "qa"

    @property
    def references(self) -> Path:
        """Maps of true range, if they were made for the run."""
        return self.root / "references"

    @property
    def models(self) -> Path:
        """Datasets, models and their scores: one folder for each stage that makes them."""
        return self.root / "models"

    @property
    def ledger(self) -> Path:
        """What is done and what was rejected, as a database; see `panokit.ledger`."""
        return self.root / "ledger.sqlite"

    @property
    def log_file(self) -> Path:
        """What happened when."""
        return self.root / "log.jsonl"

    @property
    def is_run(self) -> bool:
        """Whether this folder holds a run."""
        return (self.root / "run.json").is_file() or self.captures.is_dir()

    def create(self) -> "RunFolder":
        """Make the folder, or find out now that it cannot be written.

        Raises:
            StorageError: If it cannot.
        """
        try:
            self.root.mkdir(parents=True, exist_ok=True)
            (self.root / ".writable.part").write_bytes(b"")
            (self.root / ".writable.part").unlink()
        except OSError as error:
            raise storage_error("write to", self.root, error) from error
        return self

    def write_settings(self, settings: Mapping[str, Any]) -> None:
        """Record what the run was asked for, all defaults included."""
        write_json(self.root / "run.json", {"schema": "panokit.run/1", "settings": dict(settings)})

    def write_manifest(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Record the outcome of every item, one JSON line each, in a stable order."""
        lines = [json.dumps(row, sort_keys=True, ensure_ascii=False) for row in rows]
        write_bytes(self.root / "manifest.jsonl", "".join(f"{x}\n" for x in lines).encode())

    def log(self, event: str, **values: Any) -> None:
        """Append a line to log.jsonl: the only file that knows the clock."""
        line = {"time": round(time.time(), 3), "event": event, **values}
        try:
            with self.log_file.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line, ensure_ascii=False, default=str) + "\n")
        except OSError as error:
            raise storage_error("write", self.log_file, error) from error

    def mend_log(self) -> None:
        """End a last line of log.jsonl that a kill or a full disk had cut off."""
        try:
            with self.log_file.open("rb+") as file:
                if file.seek(0, 2) and file.seek(-1, 2) >= 0 and file.read(1) != b"\n":
                    file.write(b"\n")
        except FileNotFoundError:
            return
        except OSError as error:
            raise storage_error("write", self.log_file, error) from error

    def events(self) -> Iterator[dict[str, Any]]:
        """The lines of log.jsonl in order; one that was cut off is left out."""
        try:
            with self.log_file.open(encoding="utf-8", errors="replace") as file:
                for line in file:
                    try:
                        event = json.loads(line)
                    except ValueError:
                        continue
                    if isinstance(event, dict):
                        yield event
        except FileNotFoundError:
            return
        except OSError as error:
            raise storage_error("read", self.log_file, error) from error

    def remove_leftovers(self) -> int:
        """Delete the temporary files that a killed run left; returns how many there were."""
        leftovers = [path for path in self.root.rglob("*.part") if path.is_file()]
        for path in leftovers:
            try:
                path.unlink()
            except OSError as error:
                raise storage_error("delete", path, error) from error
        return len(leftovers)


def require_folder(path: Path) -> Path:
    """The path, if it is a folder that can be read.

    Raises:
        StorageError: If not.
    """
    try:
        next(iter(path.iterdir()), None)
    except OSError as error:
        raise storage_error("read the folder", path, error) from error
    except RuntimeError as error:  # a loop of symbolic links
        raise StorageError(f"Cannot read the folder {path}: {error}. Check the path.") from error
    return path

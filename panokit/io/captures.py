"""What fetch leaves on disk for one picture: its bytes, as they came, and a record of them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panokit.capture import Capture, TileGrid, View
from panokit.errors import RecordError
from panokit.io.files import read_bytes, read_json, sha256_of_bytes, write_json

RECORD = "capture.json"
SCHEMA = "panokit.capture/1"
_TILE = re.compile(r"^tiles/(\d+)_(\d+)\.\w+$")


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredCapture:
    """A capture with the files that hold its pixels.

    Attributes:
        folder: Where it lies.
        capture: Place, time, pose and license.
        grid: How its tiles lie in the panorama, or None for one whole picture.
        views: How its overlapping views lie in the world; () for tiles or one whole picture.
        files: Name in the folder -> SHA-256. "image.jpg" (or another suffix) for a whole
            picture, "tiles/COLUMN_ROW.jpg" for tiles, "views/NUMBER.jpg" for views.
    """

    folder: Path
    capture: Capture
    grid: TileGrid | None = None
    views: tuple[View, ...] = ()
    files: Mapping[str, str]

    def read(self, name: str) -> bytes:
        """One of the files.

        Raises:
            RecordError: If its bytes are not those that were stored.
        """
        data = read_bytes(self.folder / name)
        if sha256_of_bytes(data) != self.files[name]:
            raise RecordError(
                f"{self.folder / name} has changed since it was fetched. Delete "
                f"{self.folder} and fetch again.",
                reason="changed-on-disk",
            )
        return data


def tile_name(column: int, row: int, suffix: str = ".jpg") -> str:
    """The name of a tile's file in the capture's folder."""
    return f"tiles/{column}_{row}{suffix}"


def cell_of_tile(name: str) -> tuple[int, int] | None:
    """(column, row) of a tile's file, or None for other files."""
    match = _TILE.match(name)
    return (int(match[1]), int(match[2])) if match else None


def write_capture(stored: StoredCapture, raw: Any = None) -> None:
    """Write the record of a capture whose files are all in place; with it the capture exists.

    Args:
        stored: The capture.
        raw: The provider's own description, kept as it came.
    """
    record = {
        "schema": SCHEMA,
        "capture": stored.capture.to_json(),
        "grid": stored.grid and stored.grid.to_json(),
        "files": dict(stored.files),
        "raw": raw,
    }
    if stored.views:
        record["views"] = [view.to_json() for view in stored.views]
    write_json(stored.folder / RECORD, record)


def read_capture(folder: Path) -> StoredCapture:
    """The capture that a folder holds.

    Raises:
        RecordError: If there is no complete one.
    """
    record = read_json(folder / RECORD)
    if record.get("schema") != SCHEMA:
        raise RecordError(
            f"{folder / RECORD} is a {record.get('schema')!r} record, not {SCHEMA!r}. "
            "Fetch again with this version of panokit.",
            reason="other-schema",
        )
    return StoredCapture(
        folder=folder,
        capture=Capture.from_json(record["capture"]),
        grid=TileGrid.from_json(record["grid"]) if record["grid"] else None,
        views=tuple(View.from_json(view) for view in record.get("views", ())),
        files=record["files"],
    )

"""manifest.csv: what is known of the maps in a folder that have no records of their own."""

import csv
from dataclasses import dataclass
from pathlib import Path

from panokit.capture import License, license_from_spdx
from panokit.errors import RecordError, StorageError

NAME = "manifest.csv"


@dataclass(frozen=True, slots=True, kw_only=True)
class ManifestRow:
    """One map of a folder.

    Attributes:
        name: Unique in the folder.
        path: Of the map.
        category: The kind of scene, without its "+urban" mark; "" if not said.
        group: Maps of one group show one place; the name if not said.
        license: Of the map; nothing is permitted by one that is not known.
        usable_for: "training", or why not; "training" if not said.
        sha256: Of the file; "" if not said.
    """

    name: str
    path: Path
    category: str
    group: str
    license: License
    usable_for: str
    sha256: str


def read_manifest(folder: Path) -> tuple[ManifestRow, ...]:
    """The rows of `folder`/manifest.csv, by name.

    The columns `name` and `file` are required; `category`, `split_group`, `licence`,
    `attribution`, `usable_for` and `sha256` are read if they are there.

    Raises:
        StorageError: If it cannot be read.
        RecordError: If a required column is missing.
    """
    path = folder / NAME
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        raise StorageError(f"Cannot read {path}: {error.strerror}.") from error
    try:
        found = [_row(folder, row) for row in rows]
    except KeyError as error:
        raise RecordError(f"{path} has no column {error}.", reason="bad-manifest") from error
    return tuple(sorted(found, key=lambda row: row.name))


def _row(folder: Path, row: dict[str, str]) -> ManifestRow:
    # Some write "CC-BY-4.0 (c) 2021 Somebody": the identifier, then whom to credit.
    identifier, _, credit = (row.get("licence") or "unknown").partition(" ")
    return ManifestRow(
        name=row["name"],
        path=folder / row["file"],
        category=(row.get("category") or "").split("+")[0],
        group=row.get("split_group") or row["name"],
        license=license_from_spdx(identifier, row.get("attribution") or credit),
        usable_for=row.get("usable_for") or "training",
        sha256=row.get("sha256") or "",
    )

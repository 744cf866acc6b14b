"""manifest.csv: what is known of the maps in a folder that have no records of their own."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from panokit.capture import License, license_from_spdx
from panokit.errors import RecordError
from panokit.io.files import storage_error

NAME = "manifest.csv"


@dataclass(frozen=True, slots=True, kw_only=True)
class ManifestRow:
    """One map of a folder.

    Attributes:
        name: Unique in the folder; the file's, without its suffix, if not said.
        path: Of the map.
        category: The kind of scene, without its "+urban" mark; "" if not said.
        group: Maps of one group show one place; the name if not said.
        license: Of the map; nothing is permitted by one that is not known.
        usable_for: "training", or why not; "training" if not said.
        sha256: Of the file; "" if not said.
        tags: Words to find it by, the category's marks among them.
        place: The city or area, or the group; "" if neither is said.
        source_url: A page for people; "" if not said.
        latitude_deg: North positive, or None.
        longitude_deg: East positive, or None.
    """

    name: str
    path: Path
    category: str
    group: str
    license: License
    usable_for: str
    sha256: str
    tags: tuple[str, ...] = ()
    place: str = ""
    source_url: str = ""
    latitude_deg: float | None = None
    longitude_deg: float | None = None


def read_manifest(folder: Path) -> tuple[ManifestRow, ...]:
    """The rows of `folder`/manifest.csv, by name.

    The column `file` is required; `name`, `category`, `tags` (with spaces between),
    `split_group`, `place`, `licence` or `license` (an SPDX id), `attribution`, `usable_for`,
    `sha256`, `source_url`, `latitude_deg` and `longitude_deg` are read if they are there.

    Raises:
        StorageError: If it cannot be read.
        RecordError: If it is damaged; the message names the line.
    """
    path = folder / NAME
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except (UnicodeDecodeError, csv.Error) as error:
        raise RecordError(
            f"{path} is no CSV table ({error}). Save it as CSV in UTF-8.", reason="bad-manifest"
        ) from error
    except OSError as error:
        raise storage_error("read", path, error) from error
    found = []
    for number, row in enumerate(rows, start=2):
        values = {key: (text or "").strip() for key, text in row.items() if isinstance(key, str)}
        if not values.get("file"):
            raise RecordError(
                f"{path}, line {number}: there is no `file`. Each line names one in that column.",
                reason="bad-manifest",
            )
        try:
            found.append(_row(folder, values))
        except ValueError as error:
            raise RecordError(
                f"{path}, line {number}: {error}. Mend the line.", reason="bad-manifest"
            ) from error
    return tuple(sorted(found, key=lambda row: row.name))


def _row(folder: Path, row: Mapping[str, str]) -> ManifestRow:
    # Some write "CC-BY-4.0 (c) 2021 Somebody": the identifier, then whom to credit.
    identifier, _, credit = (row.get("licence") or row.get("license") or "unknown").partition(" ")
    # "outdoor_night+urban" is a category with a mark.
    category, *marks = (row.get("category") or "").split("+")
    name = row.get("name") or Path(row["file"]).stem
    return ManifestRow(
        name=name,
        path=folder / row["file"],
        category=category,
        group=row.get("split_group") or name,
        license=license_from_spdx(identifier, row.get("attribution") or credit),
        usable_for=row.get("usable_for") or "training",
        sha256=row.get("sha256") or "",
        tags=(*marks, *(row.get("tags") or "").split()),
        place=row.get("place") or row.get("split_group") or "",
        source_url=row.get("source_url") or "",
        latitude_deg=_degrees(row, "latitude_deg", 90),
        longitude_deg=_degrees(row, "longitude_deg", 180),
    )


def _degrees(row: Mapping[str, str], name: str, limit: float) -> float | None:
    text = row.get(name)
    if not text:
        return None
    value = float(text)
    if not -limit <= value <= limit:
        raise ValueError(f"{name} is {value:g}, not {-limit:g} to {limit:g}")
    return value

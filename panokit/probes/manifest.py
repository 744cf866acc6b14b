"""manifest.csv: what somebody wrote down about a folder of HDRIs.

One line for each file. Only `file` is needed; read are also `name`, `category`, `tags` (with
spaces between), `place` or `split_group` (maps of one group show one place), `license` (or
`licence`; an SPDX id), `attribution`, `source_url`, `latitude_deg` and `longitude_deg`. Other
columns are left alone.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panokit.capture import Capture, license_from_spdx, local_capture
from panokit.errors import RecordError, UsageError
from panokit.io.files import storage_error

NAME = "manifest.csv"


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """What a manifest says of one file.

    Attributes:
        name: What to call the map, "" for the file's name.
        category: The kind of scene, "" where it is not said.
        tags: Words to find it by.
        known: What a capture of it would hold: license, place, ...
    """

    name: str = ""
    category: str = ""
    tags: tuple[str, ...] = ()
    known: Mapping[str, Any]


def read_manifest(folder: Path) -> dict[str, Line]:
    """File name -> what the folder's manifest says of it; empty where there is no manifest.

    Raises:
        RecordError: If the manifest is damaged; the message names the line.
        StorageError: If it cannot be read.
    """
    path = folder / NAME
    if not path.is_file():
        return {}
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except (UnicodeDecodeError, csv.Error) as error:
        raise RecordError(f"{path} is no CSV table ({error}).", reason="bad-manifest") from error
    except OSError as error:
        raise storage_error("read", path, error) from error
    lines = {}
    for number, row in enumerate(rows, start=2):
        values = {key: (text or "").strip() for key, text in row.items() if isinstance(key, str)}
        if not values.get("file"):
            raise RecordError(
                f"{path}, line {number}: there is no `file`. Name one in each line.",
                reason="bad-manifest",
            )
        try:
            lines[values["file"]] = _line(values)
        except (ValueError, UsageError) as error:
            raise RecordError(
                f"{path}, line {number}: {error} Mend the line.", reason="bad-manifest"
            ) from error
    return lines


def capture_for(path: Path, known: Mapping[str, Any], spdx: str, attribution: str) -> Capture:
    """The capture of a map that has no record of its own.

    Args:
        path: Of the map.
        known: What a manifest says of it.
        spdx: The license, where the manifest names none; "" for "unknown".
        attribution: Whom to credit, where the manifest does not say.
    """
    terms = {}
    if "license" not in known and (spdx or attribution):
        terms["license"] = license_from_spdx(spdx or "unknown", attribution)
    return local_capture(path.stem, **{**terms, **known})


def _line(values: Mapping[str, str]) -> Line:
    known: dict[str, Any] = {}
    spdx = values.get("license") or values.get("licence") or ""
    if spdx:
        known["license"] = license_from_spdx(spdx, values.get("attribution", ""))
    place = values.get("place") or values.get("split_group")
    if place:
        known["place"] = place
    if values.get("source_url"):
        known["source_url"] = values["source_url"]
    for name in ("latitude_deg", "longitude_deg"):
        if values.get(name):
            known[name] = float(values[name])
    # "outdoor_night+urban" is a category with a mark.
    category, *marks = values.get("category", "").split("+")
    return Line(
        name=values.get("name", ""),
        category=category,
        tags=(*marks, *values.get("tags", "").split()),
        known=known,
    )

"""The HDR probes that methods are trained and judged on, and their folds.

With a manifest.csv the probes know their kind of scene, and which of them show one place;
without one, every map of the folder stands for itself.
"""

import csv
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.errors import RecordError, StorageError, UsageError
from panokit.io import read_environment_map
from panokit.io.files import read_bytes
from panokit.io.pictures import HDR_SUFFIXES
from panokit.records import require_folder
from panokit.sphere import resize_radiance

# Wide enough for thin lamps to clip as they would in a photograph, small enough to be quick.
PROBE_WIDTH_PX = 1024
UNSORTED = "unsorted"


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedProbe:
    """One line of a probe manifest.

    Attributes:
        name: Unique in the manifest.
        path: Of the map.
        category: The kind of scene, without its "+urban" mark.
        group: Probes of one group show one place; they stay on one side of every split.
        sha256: Of the file, as the manifest says.
    """

    name: str
    path: Path
    category: str
    group: str
    sha256: str

    def radiance(self) -> NDArray[np.float32]:
        """The map, (512, 1024, 3) float32, linear."""
        radiance = read_environment_map(self.path).radiance
        return np.ascontiguousarray(resize_radiance(radiance, PROBE_WIDTH_PX))


def read_probes(folder: Path, usable_for: str = "training") -> list[ListedProbe]:
    """The probes of `folder`/manifest.csv whose `usable_for` begins so, by name.

    Raises:
        StorageError: If there is no manifest.
        RecordError: If a column is missing or no probe is usable.
    """
    manifest = folder / "manifest.csv"
    try:
        with manifest.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        raise StorageError(f"Cannot read {manifest}: {error.strerror}.") from error
    try:
        probes = [
            ListedProbe(
                name=row["name"],
                path=folder / row["file"],
                category=row["category"].split("+")[0],
                group=row["split_group"],
                sha256=row["sha256"],
            )
            for row in rows
            if row["usable_for"].startswith(usable_for)
        ]
    except KeyError as error:
        raise RecordError(f"{manifest} has no column {error}.", reason="bad-manifest") from error
    if not probes:
        raise RecordError(f"{manifest} lists no probe for {usable_for}.", reason="no-probes")
    return sorted(probes, key=lambda probe: probe.name)


def find_probes(folder: Path) -> list[ListedProbe]:
    """The probes of a folder, by name: those of its manifest, or else every .exr and .hdr.

    Raises:
        StorageError: If the folder cannot be read.
        RecordError: If its manifest is damaged.
        UsageError: If there is no map in it.
    """
    if (folder / "manifest.csv").is_file():
        return read_probes(folder)
    maps = sorted(path for path in require_folder(folder).iterdir() if _is_map(path))
    if not maps:
        raise UsageError(
            f"There is no manifest.csv and no .exr or .hdr in {folder}. Give a folder of probes."
        )
    return [
        ListedProbe(
            name=path.stem,
            path=path,
            category=UNSORTED,
            group=path.stem,
            sha256=hashlib.sha256(read_bytes(path)).hexdigest(),
        )
        for path in maps
    ]


def assign_folds(probes: Sequence[ListedProbe], count: int) -> NDArray[np.int64]:
    """Which fold judges each probe: whole groups, each category spread over all folds."""
    category_of = {probe.group: probe.category for probe in probes}
    groups = sorted(category_of, key=lambda group: (category_of[group], group))
    fold_of = {group: position % count for position, group in enumerate(groups)}
    return np.array([fold_of[probe.group] for probe in probes])


def _is_map(path: Path) -> bool:
    return path.suffix.lower() in HDR_SUFFIXES and path.is_file()

"""The HDR probes that methods are trained and judged on, and their folds.

With a manifest.csv the probes know their kind of scene, and which of them show one place;
without one, every map of the folder stands for itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.errors import RecordError, UsageError
from panokit.io import read_environment_map
from panokit.io.files import sha256_of_file
from panokit.io.pictures import HDR_SUFFIXES
from panokit.io.probe_manifest import NAME, read_manifest
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
        sha256: Of the file, as the manifest says where it does.
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

    What the manifest leaves out is as without one, see `panokit.io.probe_manifest.ManifestRow`;
    a digest that it does not have is that of the file.

    Raises:
        StorageError: If there is no manifest, or a map that it names cannot be read.
        RecordError: If it is damaged (`reason` "bad-manifest"), or no probe is usable
            ("no-probes").
    """
    probes = [
        ListedProbe(
            name=row.name,
            path=row.path,
            category=row.category or UNSORTED,
            group=row.group,
            sha256=row.sha256 or sha256_of_file(row.path),
        )
        for row in read_manifest(folder)
        if row.usable_for.startswith(usable_for)
    ]
    if not probes:
        raise RecordError(
            f"{folder / NAME} lists no probe for {usable_for}. Say so in its column usable_for.",
            reason="no-probes",
        )
    return probes


def find_probes(folder: Path) -> list[ListedProbe]:
    """The probes of a folder, by name: those of its manifest, or else every .exr and .hdr.

    Raises:
        StorageError: If the folder cannot be read.
        RecordError: If its manifest is damaged.
        UsageError: If there is no map in it.
    """
    if (folder / NAME).is_file():
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
            sha256=sha256_of_file(path),
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

"""The HDR probes to train and judge on, and their folds."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture, require_right_to_train
from panokit.errors import RecordError, StorageError
from panokit.io import read_environment_map
from panokit.io.files import read_json
from panokit.io.pictures import record_path
from panokit.sphere import resize_radiance

# Wide enough for thin lamps to clip as they would in a photograph, small enough to be quick.
PROBE_WIDTH_PX = 1024


@dataclass(frozen=True, slots=True, kw_only=True)
class TrainingProbe:
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


def read_probes(folder: Path) -> list[TrainingProbe]:
    """The probes of `folder`/manifest.csv whose `usable_for` is "training", by name.

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
            TrainingProbe(
                name=row["name"],
                path=folder / row["file"],
                category=row["category"].split("+")[0],
                group=row["split_group"],
                sha256=row["sha256"],
            )
            for row in rows
            if row["usable_for"] == "training"
        ]
    except KeyError as error:
        raise RecordError(f"{manifest} has no column {error}.", reason="bad-manifest") from error
    if not probes:
        raise RecordError(f"{manifest} lists no probe for training.", reason="no-probes")
    return sorted(probes, key=lambda probe: probe.name)


def check_rights(probes: Sequence[TrainingProbe], own_right: str = "") -> None:
    """Check that the probes may be trained with, by the records beside their maps.

    A map without a record is the user's own affair.

    Args:
        probes: What is to be trained with.
        own_right: See `require_right_to_train`.

    Raises:
        LicenseError: If the license of one does not permit it.
        RecordError: If a record is damaged.
    """
    records = (read_json(path) for path in (record_path(p.path) for p in probes) if path.exists())
    known = [Capture.from_json(r["capture"]) for r in records if r.get("capture")]
    require_right_to_train(known, own_right)


def assign_folds(probes: Sequence[TrainingProbe], count: int) -> NDArray[np.int64]:
    """Which fold judges each probe: whole groups, each category spread over all folds."""
    category_of = {probe.group: probe.category for probe in probes}
    groups = sorted(category_of, key=lambda group: (category_of[group], group))
    fold_of = {group: position % count for position, group in enumerate(groups)}
    return np.array([fold_of[probe.group] for probe in probes])

"""The probes of PANOKIT_DATA, parted by place: half of the places set thresholds, half judge."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from panokit.envmap import EnvironmentMap
from panokit.io import read_environment_map

SEED = 2018


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """A captured probe as the manifest describes it."""

    name: str
    path: Path
    category: str
    stops: float
    usable: bool
    note: str
    scored: bool

    @property
    def is_outdoor(self) -> bool:
        return self.category.startswith(("outdoor", "sky"))

    @property
    def is_night(self) -> bool:
        return "night" in self.category

    def read(self) -> EnvironmentMap:
        """The map; two lossy files have tiny negative values."""
        return read_environment_map(self.path, repair=not self.usable)


def references(data: Path) -> list[Reference]:
    """All probes of the manifest, each on one side of the split with its whole group."""
    folder = data / "probes"
    with (folder / "manifest.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    groups = sorted({row["split_group"] for row in rows})
    shuffled = np.random.default_rng(SEED).permutation(len(groups))
    fixing = {groups[index] for index in shuffled[: len(groups) // 2]}
    return [
        Reference(
            name=row["name"],
            path=folder / row["file"],
            category=row["category"],
            stops=float(row["stops_max_over_median"]),
            usable=row["usable_for"] == "training",
            note=row["note"],
            scored=row["split_group"] not in fixing,
        )
        for row in rows
    ]

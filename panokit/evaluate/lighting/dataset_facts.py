"""What a dataset holds, from its index alone: splits, places, and the light of each split."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from panokit.dataset.sample import SPLITS
from panokit.dataset.storage.index import read_index

# Column -> edges of its histogram.
_HISTOGRAMS = {
    "light_elevation_deg": np.linspace(-90, 90, 37),
    "light_directedness": np.linspace(0, 1, 26),
    "roughness": np.linspace(0, 1, 21),
}


def describe_dataset(folder: Path, judged: str) -> dict[str, Any]:
    """The facts, for `json.dump`.

    Args:
        folder: Of the dataset.
        judged: The split that models are judged on.

    Raises:
        StorageError: If there is no dataset.
    """
    table = read_index(folder)
    return {
        "name": folder.resolve().name,
        "judged": judged,
        "splits": {split: _split(table.filter(pc.equal(table.column("split"), split)))
                   for split in SPLITS},
        "probes": _probes(table),
    }  # fmt: skip


def _split(part: pa.Table) -> dict[str, Any]:
    return {
        "samples": part.num_rows,
        "places": sorted(_distinct(part, "place")),
        "maps": len(_distinct(part, "probe")),
        "objects": len(_distinct(part, "object")),
        "kinds": _counts(part, "probe_kind"),
        "categories": _counts(part, "probe_category"),
        "histograms": {
            name: {"edges": [round(float(edge), 6) for edge in edges],
                   "counts": np.histogram(_values(part, name), edges)[0].tolist()}
            for name, edges in _HISTOGRAMS.items()
        },
    }  # fmt: skip


def _probes(table: pa.Table) -> list[dict[str, Any]]:
    """A record for each map: where it is from, how often it is used, how directed its light is."""
    columns = {
        name: table.column(name).to_pylist() if name in table.column_names else
        [None] * table.num_rows
        for name in ("probe", "place", "probe_kind", "probe_category", "split",
                     "light_directedness", "light_elevation_deg")
    }  # fmt: skip
    found: dict[str, dict[str, Any]] = {}
    light: dict[str, list[tuple[float, float]]] = {}
    for row in zip(*columns.values(), strict=True):
        name, place, kind, category, split, directed, elevation = row
        record = found.setdefault(
            name,
            {"probe": name, "place": place, "kind": kind, "category": category, "split": split,
             "samples": 0},
        )  # fmt: skip
        record["samples"] += 1
        if directed is not None and elevation is not None:
            light.setdefault(name, []).append((directed, elevation))
    for name, pairs in light.items():
        directed, elevation = np.mean(pairs, axis=0)
        found[name] |= {"directedness": round(float(directed), 4),
                        "elevation_deg": round(float(elevation), 2)}  # fmt: skip
    return [found[name] for name in sorted(found, key=str)]


def _distinct(part: pa.Table, column: str) -> list[str]:
    return [str(one) for one in pc.unique(part.column(column)).to_pylist()]


def _counts(part: pa.Table, column: str) -> dict[str, int]:
    return dict(Counter(str(one) for one in part.column(column).to_pylist()).most_common())


def _values(part: pa.Table, column: str) -> np.ndarray:
    if column not in part.column_names:
        return np.zeros(0)
    return np.array(part.column(column).drop_null().to_pylist(), np.float64)

"""The index as a Parquet table, for notebooks and databases."""

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from panokit.io import atomic_write
from panokit.probes.entry import Entry
from panokit.probes.library import Library

_TEXT = ("id", "name", "category", "kind", "place", "provider", "license", "attribution",
         "verdict")  # fmt: skip
_FLAGS = ("has_sun", "in_place", "storable", "derivable", "trainable")
_NUMBERS = ("latitude_deg", "longitude_deg", "plausibility", "dynamic_range_stops", "top_share",
            "sun_azimuth_deg", "sun_elevation_deg")  # fmt: skip

TABLE_SCHEMA = pa.schema(
    [
        *(pa.field(name, pa.string()) for name in _TEXT),
        pa.field("time", pa.timestamp("s", tz="UTC")),
        pa.field("width_px", pa.int32()),
        *(pa.field(name, pa.float64()) for name in _NUMBERS),
        *(pa.field(name, pa.bool_()) for name in _FLAGS),
        pa.field("tags", pa.list_(pa.string())),
        pa.field("descriptor", pa.list_(pa.float64())),
        pa.field("map", pa.string()),
    ]
)


def write_index_table(library: Library, ids: Sequence[str], path: Path) -> int:
    """Write one row for each probe: all that the index knows, its descriptor, and its map's file.

    Args:
        library: Where the probes are.
        ids: Whole ids, in the order of the rows.
        path: The .parquet file, written atomically.

    Returns:
        The number of rows.

    Raises:
        StorageError: If it cannot be written.
    """
    descriptors = library.descriptors()
    rows = [_row(library, entry, descriptors.get(entry.id, ())) for entry in library.entries(ids)]
    with atomic_write(path) as part:
        pq.write_table(pa.Table.from_pylist(rows, schema=TABLE_SCHEMA), part)
    return len(rows)


def _row(library: Library, entry: Entry, descriptor: Sequence[float]) -> dict[str, object]:
    row: dict[str, object] = dict(entry.to_json())
    row["time"] = datetime.fromisoformat(entry.time) if entry.time else None
    row["descriptor"] = list(descriptor)
    row["map"] = str(library.map_path(entry.id))
    return row

"""Reading the shipped tables, which `python -m panokit.metrics.transport.bake` makes."""

import lzma
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import as_file, files
from typing import Any

import numpy as np
from numpy.typing import NDArray

FOLDER = files("panokit.metrics.transport") / "tables"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlaneTable:
    """How much of each light each patch of the plane scene sees, as changes along rows of lights.

    Attributes:
        size_px: Width and height of the picture.
        rays: Rays through each pixel are the square of this.
        columns: Of the grid of lights, around the horizon.
        rows: Of it, from the zenith to the horizon.
        unit: The whole number that stands for "all visible".
        counts: (patches * rows,) changes in each row of lights, patch after patch.
        places: (changes,) the column from which on the visible share is another.
        changes: (changes,) by how many units.
    """

    size_px: int
    rays: int
    columns: int
    rows: int
    unit: int
    counts: NDArray[np.uint8]
    places: NDArray[np.intp]
    changes: NDArray[np.int8]


@lru_cache(maxsize=8)
def ball_table(scene: str) -> NDArray[np.float32]:
    """A ball's table, (orders, radii, rings) float32, read-only; see `linear.Turning`."""
    stored = _stored(f"{scene}.npz")
    whole = np.frombuffer(lzma.decompress(stored["whole"].tobytes()), "<i2")
    exponent = stored["exponent"]
    whole = whole.reshape(*exponent.shape, int(stored["orders"])).transpose(2, 0, 1)
    table = np.ascontiguousarray(whole * np.exp2(exponent.astype(np.float32)), np.float32)
    table.setflags(write=False)
    return table


@lru_cache(maxsize=1)
def plane_table() -> PlaneTable:
    """The table of the plane scene."""
    stored = _stored("plane.npz")
    size_px, rays, columns, rows, unit = (int(value) for value in stored["sizes"])
    counts = np.frombuffer(lzma.decompress(stored["counts"].tobytes()), np.uint8)
    steps = np.frombuffer(lzma.decompress(stored["steps"].tobytes()), "<u2")
    changes = np.frombuffer(lzma.decompress(stored["changes"].tobytes()), np.int8)
    # Steps from change to change within a row; the sum of all before a row is taken off.
    total = np.cumsum(steps, dtype=np.int64)
    ends = np.cumsum(counts, dtype=np.int64)
    before = np.concatenate([[0], total])[ends - counts]
    places = (total - np.repeat(before, counts)).astype(np.intp)
    return PlaneTable(
        size_px=size_px,
        rays=rays,
        columns=columns,
        rows=rows,
        unit=unit,
        counts=counts,
        places=places,
        changes=changes,
    )


def _stored(name: str) -> dict[str, NDArray[Any]]:
    with as_file(FOLDER / name) as path, np.load(path, allow_pickle=False) as archive:
        return dict(archive)

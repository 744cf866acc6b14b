"""Reading the shipped tables, which `python -m panokit.metrics.transport.bake` makes."""

from functools import lru_cache
from importlib.resources import as_file, files
from typing import Any

import numpy as np
from numpy.typing import NDArray

FOLDER = files("panokit.metrics.transport") / "tables"


@lru_cache(maxsize=8)
def ball_table(scene: str) -> NDArray[np.float32]:
    """A ball's table, (orders, radii, rings) float32, read-only; see `linear.Turning`."""
    stored = _stored(f"{scene}.npz")
    # Stored as differences along the rings, which pack better.
    whole = np.cumsum(stored["steps"], axis=2, dtype=np.int32)
    table = np.asarray(whole * stored["unit"], np.float32)
    table.setflags(write=False)
    return table


def _stored(name: str) -> dict[str, NDArray[Any]]:
    with as_file(FOLDER / name) as path, np.load(path, allow_pickle=False) as archive:
        return dict(archive)

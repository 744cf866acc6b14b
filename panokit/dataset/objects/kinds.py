"""The kinds of procedural objects, and the object of a kind and number."""

from collections.abc import Callable

import numpy as np

from panokit.dataset.objects import cases, seating, vessels
from panokit.dataset.objects.shaping import generator_of
from panokit.dataset.objects.solids import Solids
from panokit.dataset.scene import Mesh
from panokit.errors import UsageError

# Bump when the same id gives another mesh.
RECIPE = "1"

KINDS: dict[str, Callable[[Solids, np.random.Generator], None]] = {
    "armchair": seating.armchair,
    "bed": seating.bed,
    "bench": seating.bench,
    "bottle": vessels.bottle,
    "bowl": vessels.bowl,
    "cabinet": cases.cabinet,
    "candlestick": vessels.candlestick,
    "chair": seating.chair,
    "desk": cases.desk,
    "lamp": vessels.lamp,
    "mug": vessels.mug,
    "plant": vessels.plant,
    "shelf": cases.shelf,
    "sofa": seating.sofa,
    "stool": seating.stool,
    "table": cases.table,
    "teapot": vessels.teapot,
    "vase": vessels.vase,
}


def make_object(kind: str, number: int) -> Mesh:
    """A piece of furniture, the same for the same kind and number in every process.

    Args:
        kind: One of `KINDS`.
        number: 0 or more; there is no end.

    Returns:
        A smooth mesh with creases, centered at the origin, its longest side 1 m, of closed
        solids in up to three parts; 200 to 6,000 triangles.

    Raises:
        UsageError: If there is no such kind, or the number is negative.
    """
    if kind not in KINDS:
        raise UsageError(f"There is no kind of object {kind!r}. Choose from {', '.join(KINDS)}.")
    if number < 0:
        raise UsageError(f"Objects are numbered from 0, not {number}.")
    solids = Solids()
    KINDS[kind](solids, generator_of(f"{kind}-{number}"))
    return solids.mesh()

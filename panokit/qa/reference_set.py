"""The figures of reference maps that a map is placed among: those that ship, or a user's own."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError

SCHEMA = "panokit.qa-reference/1"
_SHIPPED = Path(__file__).parent / "reference.json"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReferenceSet:
    """Figures of captured maps, by category.

    Attributes:
        figures: The names of the columns.
        categories: Category -> (maps, figures) float64.
        source: Where the maps are from, in words.
    """

    figures: tuple[str, ...]
    categories: Mapping[str, NDArray[np.float64]]
    source: str


def shipped_reference() -> ReferenceSet:
    """The figures of captured CC0 probes of HDRI Haven that travel with panokit."""
    return _read(_SHIPPED)


def own_reference(
    maps: Sequence[Mapping[str, float]], figures: Sequence[str], least: int
) -> ReferenceSet | None:
    """A reference set of one category from the figures of a user's maps; None if too few.

    Args:
        maps: The figures of each map, by name; those that lack a figure are left out.
        figures: Which, in order.
        least: Fewer maps than this make no distribution.
    """
    rows = [[m[name] for name in figures] for m in maps if all(name in m for name in figures)]
    if len(rows) < least:
        return None
    return ReferenceSet(
        figures=tuple(figures),
        categories={"reference": np.array(rows, np.float64)},
        source="the maps of --reference",
    )


@lru_cache(maxsize=1)
def _read(path: Path) -> ReferenceSet:
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        if record["schema"] != SCHEMA:
            raise ValueError(record["schema"])
        categories = {
            name: np.array(rows, np.float64) for name, rows in record["categories"].items()
        }
        return ReferenceSet(
            figures=tuple(record["figures"]), categories=categories, source=record["source"]
        )
    except (OSError, KeyError, ValueError, TypeError) as error:
        raise UsageError(
            f"The reference figures of QA are damaged ({error}). Install panokit again."
        ) from error

"""Searching a large area by cells: a cell that holds too much to list is cut into four."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from panokit.fetch.geodesy import LatLon

Item = TypeVar("Item")
Bbox = tuple[float, float, float, float]  # west, south, east, north in degrees

_LEAST_SIDE_DEG = 0.0005  # about 50 m: cutting further would bring no other street


@dataclass(frozen=True, slots=True)
class Listing(Generic[Item]):
    """What a search of a box returned.

    Attributes:
        items: What was found.
        is_complete: Whether that is all there is.
    """

    items: Sequence[Item]
    is_complete: bool


class Cells(Generic[Item]):
    """A quadtree over an area that is searched where somebody looks, and only once.

    Args:
        bbox_deg: West, south, east, north.
        search: Lists what lies in a box.
    """

    def __init__(self, bbox_deg: Bbox, search: Callable[[Bbox], Listing[Item]]) -> None:
        self._root = bbox_deg
        self._search = search
        self._listings: dict[Bbox, Listing[Item]] = {}

    def around(self, point_deg: LatLon) -> Sequence[Item]:
        """Everything in the cell that holds a point; at worst what the search would list."""
        cell = self._root
        while True:
            if cell not in self._listings:
                self._listings[cell] = self._search(cell)
            listing = self._listings[cell]
            if listing.is_complete or max(cell[2] - cell[0], cell[3] - cell[1]) < _LEAST_SIDE_DEG:
                return listing.items
            cell = _quarter(cell, point_deg)


def _quarter(cell: Bbox, point_deg: LatLon) -> Bbox:
    west, south, east, north = cell
    middle_x, middle_y = (west + east) / 2, (south + north) / 2
    latitude, longitude = point_deg
    west, east = (middle_x, east) if longitude >= middle_x else (west, middle_x)
    south, north = (middle_y, north) if latitude >= middle_y else (south, middle_y)
    return west, south, east, north

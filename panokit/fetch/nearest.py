"""Points -> the pictures nearest to them, for services that list what lies in a box."""

from collections.abc import Callable, Iterator, Sequence

from panokit.fetch.cells import Bbox, Cells, Listing
from panokit.fetch.geodesy import LatLon, distance_m, offset
from panokit.fetch.places import Place
from panokit.fetch.provider import Found


class NearestPictures:
    """Gives each picture once, and remembers which boxes it has searched.

    Args:
        search: Lists what lies in a box.
        snap_m: How far from a point its picture may lie; None for anywhere in its cell.
    """

    def __init__(self, search: Callable[[Bbox], Listing[Found]], snap_m: float | None) -> None:
        self._search = search
        self._snap_m = snap_m
        self._cells: dict[str, Cells[Found]] = {}
        self._given: set[str] = set()

    def find(self, place: Place, points: Sequence[LatLon]) -> Iterator[Found]:
        """For each point the nearest picture that was not given yet, if there is one."""
        snap_m = place.snap_m or self._snap_m
        for point in points:
            new = [
                (apart_m, one.capture.id, one)
                for one in self._around(place, point)
                for apart_m in [distance_m(point, one.position_deg or point)]
                if one.capture.id not in self._given and (snap_m is None or apart_m <= snap_m)
            ]
            if new:
                _, id, nearest = min(new, key=lambda entry: entry[:2])
                self._given.add(id)
                yield nearest

    def _around(self, place: Place, point: LatLon) -> Sequence[Found]:
        if not place.points:
            return self._cells.setdefault(place.name, Cells(place.bbox_deg, self._search)).around(
                point
            )
        # Points of a list may be countries apart: look around each of them, and nowhere else.
        south, west = offset(point, -place.snap_m, -place.snap_m)
        north, east = offset(point, place.snap_m, place.snap_m)
        return self._search((west, south, east, north)).items

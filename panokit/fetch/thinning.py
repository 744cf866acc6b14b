"""Not the same street twice: how far apart, and how many of a cell, a sequence, a month."""

import math
from collections import Counter
from collections.abc import Iterable

from panokit.capture import Capture, TimePrecision
from panokit.fetch.geodesy import EARTH_RADIUS_M, LatLon, distance_m
from panokit.fetch.places import Place
from panokit.fetch.provider import position_of
from panokit.fetch.settings import FetchSettings

_M_PER_DEGREE = math.radians(EARTH_RADIUS_M)


class Thinning:
    """What is taken already, and which further picture would be too much of the same.

    Args:
        settings: The limits.
        place: Whose pictures are counted; distances are kept to those of all places.
        on_disk: Captures that are there before.
    """

    def __init__(
        self, settings: FetchSettings, place: Place | None, on_disk: Iterable[Capture]
    ) -> None:
        self._settings = settings
        self._positions: dict[tuple[int, int], list[LatLon]] = {}
        self._cells: set[tuple[int, int]] = set()
        self._sequences: Counter[str] = Counter()
        self._months: Counter[str] = Counter()
        for capture in on_disk:
            position = position_of(capture)
            is_of_place = place is not None and (
                capture.place == place.name or (position is not None and place.contains(position))
            )
            self.take(capture, counts=is_of_place)

    def objection(self, capture: Capture) -> str:
        """Why one more such picture is too much, "" if it is not."""
        limits, position = self._settings, position_of(capture)
        if position is not None and any(
            distance_m(position, other) < limits.min_distance_m for other in self._near(position)
        ):
            return "too-close"
        if limits.cell_m and position and cell_of(position, limits.cell_m) in self._cells:
            return "same-cell"
        if limits.per_sequence and self._sequences[sequence_of(capture)] >= limits.per_sequence:
            return "same-sequence"
        if limits.per_month and self._months[month_of(capture)] >= limits.per_month:
            return "same-month"
        return ""

    def take(self, capture: Capture, *, counts: bool = True) -> None:
        """Note that a picture is taken; one of another place counts for distances only."""
        position = position_of(capture)
        if position is not None:
            self._positions.setdefault(self._bin(position), []).append(position)
        if not counts:
            return
        if position is not None and self._settings.cell_m:
            self._cells.add(cell_of(position, self._settings.cell_m))
        # What is not known is no reason to refuse a picture.
        if sequence_of(capture):
            self._sequences[sequence_of(capture)] += 1
        if month_of(capture):
            self._months[month_of(capture)] += 1

    def _bin(self, position: LatLon) -> tuple[int, int]:
        return cell_of(position, max(self._settings.min_distance_m, 1.0))

    def _near(self, position: LatLon) -> Iterable[LatLon]:
        side_m = max(self._settings.min_distance_m, 1.0)
        row, _ = self._bin(position)
        for other_row in (row - 1, row, row + 1):
            column = _column(position[1], other_row, side_m)
            for other_column in range(column - 1, column + 2):
                yield from self._positions.get((other_row, other_column), ())


def cell_of(position_deg: LatLon, side_m: float) -> tuple[int, int]:
    """Row and column of the square cell of about this side that holds a point.

    Rows are strips of equal latitude; each is cut into columns of the side's length on the
    ground in the middle of the strip. The same cells everywhere, whatever place asks.
    """
    row = math.floor(position_deg[0] * _M_PER_DEGREE / side_m)
    return row, _column(position_deg[1], row, side_m)


def sequence_of(capture: Capture) -> str:
    """The drive or walk that a picture belongs to, "" where the service does not say."""
    return str(capture.details.get("sequence") or "")


def month_of(capture: Capture) -> str:
    """Year and month of a picture, "" where they are not known."""
    if capture.time is None or capture.time_precision is TimePrecision.YEAR:
        return ""
    return f"{capture.time:%Y-%m}"


def _column(longitude_deg: float, row: int, side_m: float) -> int:
    latitude_deg = (row + 0.5) * side_m / _M_PER_DEGREE
    shrink = max(math.cos(math.radians(max(-89.9, min(89.9, latitude_deg)))), 1e-3)
    return math.floor(longitude_deg * _M_PER_DEGREE * shrink / side_m)

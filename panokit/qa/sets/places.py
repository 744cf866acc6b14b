"""Where and when the maps of a set were taken."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, timedelta
from typing import Any

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from panokit.capture import Capture, TimePrecision

_EARTH_M = 6_371_008.8
CLUSTER_M = 50.0
# A cell is this tall, and about as wide: streets of one quarter share one.
CELL_KM = 1.0
_KM_PER_DEG = 2 * np.pi * _EARTH_M / 1000 / 360


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Where and when the maps of one set were taken.

    Attributes:
        located: Maps with a known place.
        clusters: Groups of maps that chains of steps of 50 m or less connect.
        largest_cluster: Maps in the largest.
        cells: Cells of 1 km by 1 km with a map.
        cities: Maps of each named place.
        months: Maps of each month, "01" to "12", where it is known.
        solar_hours: Maps of each hour of local solar time, "00" to "23", where the time is
            known to the second, and the place.
    """

    located: int = 0
    clusters: int = 0
    largest_cluster: int = 0
    cells: int = 0
    cities: dict[str, int] = field(default_factory=dict)
    months: dict[str, int] = field(default_factory=dict)
    solar_hours: dict[str, int] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {name: getattr(self, name) for name in self.__slots__}


def spread_of(captures: Sequence[Capture | None]) -> Spread:
    """Count places and times; maps without a record are in no count."""
    known = [capture for capture in captures if capture is not None]
    points = [place for capture in known if (place := _place(capture)) is not None]
    sizes = _cluster_sizes(points)
    return Spread(
        located=len(points),
        clusters=len(sizes),
        largest_cluster=max(sizes, default=0),
        cells=len({cell_of(*point) for point in points}),
        cities=_counted(capture.place for capture in known if capture.place),
        months=_counted(month for capture in known if (month := month_of(capture))),
        solar_hours=_counted(hour for capture in known if (hour := solar_hour_of(capture))),
    )


def cell_of(latitude_deg: float, longitude_deg: float) -> str:
    """The name of the cell of about 1 km by 1 km that a place lies in.

    Rows of latitude are cut into as many cells as are about as wide as tall.
    """
    rows = round(180 * _KM_PER_DEG / CELL_KM)
    row = min(int((latitude_deg + 90) / 180 * rows), rows - 1)
    middle = np.deg2rad((row + 0.5) / rows * 180 - 90)
    columns = max(round(360 * _KM_PER_DEG * float(np.cos(middle)) / CELL_KM), 1)
    column = min(int((longitude_deg + 180) / 360 * columns), columns - 1)
    return f"{row}-{column}"


def month_of(capture: Capture) -> str:
    """The month of a capture, "01" to "12"; "" where it is not known."""
    if capture.time is None or capture.time_precision is TimePrecision.YEAR:
        return ""
    return f"{capture.time.astimezone(UTC).month:02}"


def solar_hour_of(capture: Capture) -> str:
    """The hour of local mean solar time, "00" to "23"; "" where it cannot be known."""
    if capture.time is None or capture.time_precision is not TimePrecision.SECOND:
        return ""
    if capture.longitude_deg is None:
        return ""
    local = capture.time.astimezone(UTC) + timedelta(hours=capture.longitude_deg / 15)
    return f"{local.hour:02}"


def distance_m(first: Capture | None, second: Capture | None) -> float | None:
    """The distance on the ground between two captures; None where a place is not known."""
    places = [_place(capture) for capture in (first, second) if capture is not None]
    if len(places) < 2 or places[0] is None or places[1] is None:
        return None
    chord = float(np.linalg.norm(_points([places[0]]) - _points([places[1]])))
    return 2 * _EARTH_M * float(np.arcsin(min(chord / (2 * _EARTH_M), 1.0)))


def near_on_the_ground(
    captures: Sequence[Capture | None], within_m: float
) -> list[tuple[int, int]]:
    """The pairs (i < j) of captures within a distance."""
    places = [(i, place) for i, c in enumerate(captures) if c and (place := _place(c)) is not None]
    if len(places) < 2:
        return []
    pairs = cKDTree(_points([place for _, place in places])).query_pairs(within_m)
    return sorted((places[a][0], places[b][0]) for a, b in pairs)


def _place(capture: Capture) -> tuple[float, float] | None:
    if capture.latitude_deg is None or capture.longitude_deg is None:
        return None
    return capture.latitude_deg, capture.longitude_deg


def _points(places: Sequence[tuple[float, float]]) -> np.ndarray:
    """Places on a globe, (n, 3) in meters."""
    latitude, longitude = np.deg2rad(np.array(places, np.float64)).T
    across = np.cos(latitude)
    axes = [across * np.cos(longitude), across * np.sin(longitude), np.sin(latitude)]
    return _EARTH_M * np.stack(axes, axis=1)


def _cluster_sizes(places: Sequence[tuple[float, float]]) -> list[int]:
    if not places:
        return []
    pairs = cKDTree(_points(places)).query_pairs(CLUSTER_M, output_type="ndarray")
    count = len(places)
    links = csr_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, member = connected_components(links, directed=False)
    return [int(size) for size in np.bincount(member)]


def _counted(names: Any) -> dict[str, int]:
    return dict(sorted(Counter(names).items()))

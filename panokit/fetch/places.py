"""Areas to look for pictures in: discs, boxes, polygons, and points of the user's own."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

from panokit.errors import PlaceError
from panokit.fetch.geodesy import LatLon, distance_m, east_north_m, offset

Ring = tuple[LatLon, ...]  # the first point is not repeated at the end
Polygon = tuple[Ring, ...]  # the outline, then the holes in it


# No slots: a cached property needs a dictionary to keep its value in.
@dataclass(frozen=True, kw_only=True)
class Place:
    """A named area: a box, or the disc, the polygons or the points in it.

    Attributes:
        name: What its pictures are filed under.
        latitude_deg: Of its center.
        longitude_deg: Of its center.
        half_width_m: From the center to the east and west.
        half_height_m: From the center to the north and south.
        is_disc: Whether only the disc counts, not the corners.
        timezone: IANA name, "" where it is not known.
        polygons: Only what lies in one of them counts; () for no such limit.
        points: (latitude, longitude) of the only points to look at, each for the picture
            nearest to it; () to look everywhere.
        snap_m: How far from one of its points a picture may lie.
    """

    name: str
    latitude_deg: float
    longitude_deg: float
    half_width_m: float
    half_height_m: float
    is_disc: bool = True
    timezone: str = ""
    polygons: tuple[Polygon, ...] = field(default=(), repr=False)
    points: tuple[LatLon, ...] = field(default=(), repr=False)
    snap_m: float = 0.0

    @property
    def center_deg(self) -> LatLon:
        """(latitude, longitude)."""
        return self.latitude_deg, self.longitude_deg

    @property
    def bbox_deg(self) -> tuple[float, float, float, float]:
        """West, south, east, north."""
        south, west = offset(self.center_deg, -self.half_width_m, -self.half_height_m)
        north, east = offset(self.center_deg, self.half_width_m, self.half_height_m)
        return west, south, east, north

    def contains(self, point_deg: LatLon) -> bool:
        """Whether a point lies in the area; for points, whether it lies near one of them."""
        if self.points:
            near = self._points_by_cell.get(_cell(point_deg, self._cell_deg), ())
            return any(distance_m(point_deg, other) <= self.snap_m for other in near)
        if self.is_disc:
            return distance_m(self.center_deg, point_deg) <= self.half_width_m
        east_m, north_m = east_north_m(self.center_deg, point_deg)
        if abs(east_m) > self.half_width_m or abs(north_m) > self.half_height_m:
            return False
        return not self.polygons or any(_is_in(point_deg, one) for one in self.polygons)

    @property
    def _cell_deg(self) -> tuple[float, float]:
        """Sides of cells so large that what is near a point is in its cell or the eight around."""
        worst = max((abs(latitude) for latitude, _ in self.points), default=0.0)
        north = max(self.snap_m, 1.0) / 111_000
        return north, north / max(math.cos(math.radians(min(worst, 89.0))), 1e-3)

    @cached_property
    def _points_by_cell(self) -> dict[tuple[int, int], list[LatLon]]:
        cells: dict[tuple[int, int], list[LatLon]] = {}
        for point in self.points:
            row, column = _cell(point, self._cell_deg)
            for near in ((row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)):
                cells.setdefault(near, []).append(point)
        return cells


def disc(
    name: str, latitude_deg: float, longitude_deg: float, radius_m: float, timezone: str = ""
) -> Place:
    """The area within a radius around a point."""
    return Place(
        name=name,
        latitude_deg=latitude_deg,
        longitude_deg=longitude_deg,
        half_width_m=radius_m,
        half_height_m=radius_m,
        timezone=timezone,
    )


def box(name: str, bbox_deg: tuple[float, float, float, float]) -> Place:
    """The area between west, south, east and north."""
    return _within(name, bbox_deg)


def area(name: str, polygons: tuple[Polygon, ...]) -> Place:
    """The area inside polygons, which may have holes (even-odd rule).

    Raises:
        PlaceError: If there is none, if one has fewer than three corners or no area, or if
            they reach around more than half of the earth.
    """
    if not polygons or any(len(ring) < 3 for polygon in polygons for ring in polygon):
        raise PlaceError(f"The area {name!r} needs polygons of at least three corners.")
    bbox = _bbox_of([corner for polygon in polygons for corner in polygon[0]])
    if bbox[2] - bbox[0] > 180:
        raise PlaceError(
            f"The area {name!r} reaches around the earth. If it crosses the 180th meridian, write "
            "its two sides as two features."
        )
    around = _within(name, bbox)
    box_m2 = 4 * around.half_width_m * around.half_height_m
    inside_m2 = sum(_area_m2(polygon[0], around.center_deg) for polygon in polygons)
    if inside_m2 < max(1e-4 * box_m2, 1.0):
        raise PlaceError(
            f"The area {name!r} is no more than a line. Draw it wider, or list points instead."
        )
    return replace(around, polygons=polygons)


def points_of_interest(name: str, points: tuple[LatLon, ...], snap_m: float) -> Place:
    """Points to look at one by one, each for the picture nearest to it.

    Raises:
        PlaceError: If there is none.
    """
    if not points:
        raise PlaceError(f"{name} lists no points. Write latitude and longitude, a point a line.")
    around = _within(name, _bbox_of(points))
    return replace(
        around,
        # A picture may lie beyond the outermost point.
        half_width_m=around.half_width_m + snap_m,
        half_height_m=around.half_height_m + snap_m,
        points=points,
        snap_m=snap_m,
    )


def check_point(latitude_deg: float, longitude_deg: float, where: str = "") -> LatLon:
    """The same point, if it is one.

    Raises:
        PlaceError: If latitude or longitude are out of range, or not finite.
    """
    if not (-90 <= latitude_deg <= 90 and -180 <= longitude_deg <= 180):
        raise PlaceError(
            f"{where}{latitude_deg}, {longitude_deg} is no point: give latitude, longitude."
        )
    return latitude_deg, longitude_deg


def _bbox_of(points: list[LatLon] | tuple[LatLon, ...]) -> tuple[float, float, float, float]:
    latitudes, longitudes = [p[0] for p in points], [p[1] for p in points]
    return min(longitudes), min(latitudes), max(longitudes), max(latitudes)


def _within(name: str, bbox_deg: tuple[float, float, float, float]) -> Place:
    west, south, east, north = bbox_deg
    center = (south + north) / 2, (west + east) / 2
    east_m, north_m = east_north_m(center, (north, east))
    return Place(
        name=name,
        latitude_deg=center[0],
        longitude_deg=center[1],
        half_width_m=east_m,
        half_height_m=north_m,
        is_disc=False,
    )


def _cell(point_deg: LatLon, side_deg: tuple[float, float]) -> tuple[int, int]:
    return math.floor(point_deg[0] / side_deg[0]), math.floor(point_deg[1] / side_deg[1])


def _is_in(point_deg: LatLon, polygon: Polygon) -> bool:
    """Whether a ray to the east crosses the rings an odd number of times (the even-odd rule)."""
    y, x = point_deg
    inside = False
    for ring in polygon:
        for (y1, x1), (y2, x2) in zip(ring, (*ring[1:], ring[0]), strict=True):
            if (y1 > y) != (y2 > y) and x < (x2 - x1) * (y - y1) / (y2 - y1) + x1:
                inside = not inside
    return inside


def _area_m2(ring: Ring, center_deg: LatLon) -> float:
    """The area of a ring on the ground (the shoelace formula)."""
    xy = [east_north_m(center_deg, corner) for corner in ring]
    turns = zip(xy, (*xy[1:], xy[0]), strict=True)
    return abs(sum(x1 * y2 - x2 * y1 for (x1, y1), (x2, y2) in turns)) / 2

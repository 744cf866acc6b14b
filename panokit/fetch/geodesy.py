"""Distances on the ground, in a plane that touches the earth; good to 0.1 % within a city."""

import math

EARTH_RADIUS_M = 6371008.8
_M_PER_DEGREE = math.radians(EARTH_RADIUS_M)

LatLon = tuple[float, float]


def offset(point_deg: LatLon, east_m: float, north_m: float) -> LatLon:
    """The point that lies so far east and north of another, as (latitude, longitude)."""
    latitude = point_deg[0] + north_m / _M_PER_DEGREE
    longitude = point_deg[1] + east_m / (_M_PER_DEGREE * _shrink(point_deg[0]))
    return max(-90.0, min(90.0, latitude)), _wrap(longitude)


def east_north_m(origin_deg: LatLon, point_deg: LatLon) -> tuple[float, float]:
    """How far east and north of the origin a point lies."""
    east = _wrap(point_deg[1] - origin_deg[1]) * _M_PER_DEGREE * _shrink(origin_deg[0])
    return east, (point_deg[0] - origin_deg[0]) * _M_PER_DEGREE


def distance_m(a_deg: LatLon, b_deg: LatLon) -> float:
    """How far two points are apart."""
    return math.hypot(*east_north_m(a_deg, b_deg))


def _shrink(latitude_deg: float) -> float:
    # At the poles every longitude is the same place; a small floor keeps division sane.
    return max(math.cos(math.radians(latitude_deg)), 1e-6)


def _wrap(longitude_deg: float) -> float:
    return (longitude_deg + 180.0) % 360.0 - 180.0

"""Places from files: polygons of a GeoJSON file, discs or points of a CSV table."""

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from panokit.errors import PlaceError
from panokit.fetch.geodesy import LatLon
from panokit.fetch.places import Place, Polygon, area, check_point, disc, points_of_interest
from panokit.io.files import read_bytes

_LATITUDE = ("latitude_deg", "latitude", "lat", "y")
_LONGITUDE = ("longitude_deg", "longitude", "lon", "lng", "long", "x")
_NAME = ("name", "place", "city", "id")
_RADIUS = ("radius_m", "radius")


def places_of_file(path: Path, snap_m: float) -> list[Place]:
    """The places that a file describes.

    GeoJSON: each feature with a Polygon or MultiPolygon is a place, by the name in its
    properties; Points, LineStrings and MultiPoints are points to look at. CSV: a row with a
    radius is a disc; rows without one are points, and together they are one place.

    Args:
        path: Ends in .geojson, .json or .csv.
        snap_m: How far from a point a picture may lie.

    Raises:
        PlaceError: If it holds no places, or one that is none; the message names it.
        StorageError: If it cannot be read.
    """
    text = read_bytes(path).decode("utf-8-sig", "replace")
    match path.suffix.lower():
        case ".geojson" | ".json":
            return _from_geojson(text, path, snap_m)
        case ".csv" | ".tsv":
            return _from_csv(text, path, snap_m)
        case other:
            raise PlaceError(
                f"{path}: places come from .geojson and .csv files, not from {other or 'this'}."
            )


def _from_geojson(text: str, path: Path, snap_m: float) -> list[Place]:
    try:
        root = json.loads(text)
        features = _features(root)
    except (ValueError, AttributeError, TypeError) as error:
        raise PlaceError(f"{path} is not GeoJSON ({error}).") from None
    places: list[Place] = []
    points: list[LatLon] = []
    for number, feature in enumerate(features, start=1):
        where = f"{path}, feature {number}"
        try:
            polygons, found = _shapes(feature.get("geometry") or {})
        except (KeyError, TypeError, ValueError, IndexError) as error:
            raise PlaceError(f"{where} is not GeoJSON ({error!r}).") from None
        for corner in (*found, *(c for polygon in polygons for ring in polygon for c in ring)):
            check_point(*corner, where=f"{where}: ")
        if polygons:
            name = _named(feature.get("properties") or {}, _NAME)
            places.append(area(name or f"{path.stem} {number}", tuple(polygons)))
        points += found
    if points:
        places.append(points_of_interest(path.stem, tuple(points), snap_m))
    if not places:
        raise PlaceError(f"{path} holds no polygons and no points.")
    return places


def _features(value: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The features of any GeoJSON value: a collection, one feature, or a bare geometry."""
    match value.get("type"):
        case "FeatureCollection":
            return list(value["features"])
        case "Feature":
            return [value]
        case str():
            return [{"geometry": value}]
    raise ValueError("it has no type")


def _shapes(geometry: Mapping[str, Any]) -> tuple[list[Polygon], list[LatLon]]:
    """The polygons and the points of a geometry (RFC 7946: longitude comes first)."""
    coordinates = geometry.get("coordinates")
    match geometry.get("type"):
        case "Polygon":
            return [_polygon(coordinates)], []
        case "MultiPolygon":
            return [_polygon(one) for one in coordinates or ()], []
        case "Point":
            return [], [_point(coordinates)]
        case "MultiPoint" | "LineString":
            return [], [_point(one) for one in coordinates or ()]
        case "GeometryCollection":
            parts = [_shapes(one) for one in geometry["geometries"]]
            return [p for part in parts for p in part[0]], [p for part in parts for p in part[1]]
        case None:
            return [], []
        case other:
            raise ValueError(f"a {other} is no area")


def _polygon(rings: Any) -> Polygon:
    # The last corner of a ring repeats the first.
    return tuple(tuple(_point(corner) for corner in ring[:-1]) for ring in rings)


def _point(coordinates: Any) -> LatLon:
    return float(coordinates[1]), float(coordinates[0])


def _from_csv(text: str, path: Path, snap_m: float) -> list[Place]:
    first_line = text.partition("\n")[0]
    delimiter = next((mark for mark in ("\t", ";") if mark in first_line), ",")
    rows = csv.DictReader(text.splitlines(), delimiter=delimiter)
    columns = {name.strip().casefold(): name for name in rows.fieldnames or () if name}
    latitude, longitude = _column(columns, _LATITUDE), _column(columns, _LONGITUDE)
    if latitude is None or longitude is None:
        raise PlaceError(
            f"{path} needs the columns latitude and longitude in its first line; it has "
            f"{', '.join(columns) or 'none'}."
        )
    places: list[Place] = []
    points: list[LatLon] = []
    for row in rows:
        where = f"{path}, line {rows.line_num}: "
        try:
            point = check_point(float(row[latitude]), float(row[longitude]), where)
            radius_m = float(_named(row, _RADIUS) or 0)
        except (TypeError, ValueError) as error:
            if isinstance(error, PlaceError):
                raise
            raise PlaceError(f"{where}{error}. Latitude and longitude are degrees.") from None
        if radius_m > 0:
            name = _named(row, _NAME) or f"{point[0]:.4f} {point[1]:.4f}"
            places.append(disc(name, *point, radius_m))
        else:
            points.append(point)
    if points:
        places.append(points_of_interest(path.stem, tuple(points), snap_m))
    if not places:
        raise PlaceError(f"{path} lists no places.")
    return places


def _column(columns: Mapping[str, str], names: Sequence[str]) -> str | None:
    return next((columns[name] for name in names if name in columns), None)


def _named(row: Mapping[str, Any], names: Sequence[str]) -> str:
    """The first value that stands under one of these names, whatever their case."""
    by_name = {str(key).strip().casefold(): value for key, value in row.items() if key}
    values = (by_name.get(name) for name in names)
    return next((str(value).strip() for value in values if value not in (None, "")), "")

"""Places from GeoJSON and CSV files."""

import json
from itertools import islice

import pytest

from panokit.errors import PlaceError, StorageError
from panokit.fetch.geodesy import distance_m, offset
from panokit.fetch.place_files import places_of_file
from panokit.fetch.places import area
from panokit.fetch.sampling import sample_points

SQUARE = [[7.0, 48.0], [7.1, 48.0], [7.1, 48.1], [7.0, 48.1], [7.0, 48.0]]
HOLE = [[7.02, 48.02], [7.08, 48.02], [7.08, 48.08], [7.02, 48.08], [7.02, 48.02]]
FAR = [[9.0, 48.0], [9.1, 48.0], [9.0, 48.1], [9.0, 48.0]]


def written(tmp_path, value, name="mine.geojson"):
    path = tmp_path / name
    path.write_text(value if isinstance(value, str) else json.dumps(value))
    return path


def feature(kind, coordinates, **properties):
    return {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": kind, "coordinates": coordinates},
    }


def collection(*features):
    return {"type": "FeatureCollection", "features": list(features)}


def test_each_polygon_is_a_place_by_its_name(tmp_path):
    value = collection(
        feature("Polygon", [SQUARE], name="Center"), feature("MultiPolygon", [[SQUARE], [FAR]])
    )
    center, second = places_of_file(written(tmp_path, value), 50)
    assert (center.name, second.name) == ("Center", "mine 2")
    assert center.contains((48.05, 7.05))
    assert not center.contains((48.05, 9.02))
    assert second.contains((48.02, 9.02))
    # In the box of the triangle, but not in the triangle.
    assert not second.contains((48.09, 9.09))


def test_holes_are_not_part_of_an_area(tmp_path):
    (place,) = places_of_file(written(tmp_path, feature("Polygon", [SQUARE, HOLE])), 50)
    assert not place.contains((48.05, 7.05))
    assert place.contains((48.01, 7.01))
    points = list(islice(sample_points(place), 200))
    assert all(place.contains(point) for point in points)
    assert {point[0] > 48.05 for point in points} == {True, False}


def test_a_bare_geometry_will_do(tmp_path):
    (place,) = places_of_file(written(tmp_path, {"type": "Polygon", "coordinates": [SQUARE]}), 50)
    west, south, east, north = place.bbox_deg
    assert (west, south, east, north) == pytest.approx((7.0, 48.0, 7.1, 48.1), abs=1e-3)


def test_points_are_looked_at_one_by_one(tmp_path):
    value = collection(
        feature("Point", [7.0, 48.0]), feature("LineString", [[7.01, 48.0], [7.02, 48.0]])
    )
    (place,) = places_of_file(written(tmp_path, value), 60)
    assert list(sample_points(place)) == [(48.0, 7.0), (48.0, 7.01), (48.0, 7.02)]
    assert place.contains(offset((48.0, 7.01), 0, 59))
    assert not place.contains(offset((48.0, 7.01), 0, 61))
    assert not place.contains(offset((48.0, 7.005), 0, 0))


def test_rows_with_a_radius_are_discs_and_the_others_are_points(tmp_path):
    text = "Name;Lat;Lon;Radius\nHarbor;48.0;7.0;300\n;48.1;7.1;200\nx;48.2;7.2;\ny;48.3;7.3;\n"
    harbor, unnamed, rest = places_of_file(written(tmp_path, text, "list.csv"), 50)
    assert (harbor.name, harbor.half_width_m) == ("Harbor", 300)
    assert unnamed.name == "48.1000 7.1000"
    assert (rest.name, rest.points) == ("list", ((48.2, 7.2), (48.3, 7.3)))


def test_thousands_of_points_are_no_trouble(tmp_path):
    rows = [f"{48 + i / 1000:.4f},{7 + i / 1000:.4f}" for i in range(3000)]
    path = written(tmp_path, "latitude,longitude\n" + "\n".join(rows), "many.csv")
    (place,) = places_of_file(path, 50)
    here = (48.5, 7.5)
    near = [point for point in place.points if distance_m(here, point) <= 50]
    assert place.contains(here) == bool(near)
    assert sum(place.contains(offset(point, 10, 10)) for point in place.points) == 3000
    assert not place.contains(offset(here, 60, 0))


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.geojson", "{", "not GeoJSON"),
        ("a.geojson", "[]", "not GeoJSON"),
        ("a.json", '{"type": "FeatureCollection", "features": []}', "no polygons and no points"),
        ("a.json", '{"type": "Polygon", "coordinates": [[1, 2]]}', "feature 1"),
        ("a.json", '{"type": "Polygon", "coordinates": [[[200, 1], [201, 1], [201, 2], [200, 1]]]}',
         "feature 1: 1.0, 200.0 is no point"),
        ("a.json", '{"type": "Circle", "coordinates": []}', "a Circle is no area"),
        ("a.csv", "name,north\nx,1\n", "latitude and longitude"),
        ("a.csv", "lat,lon\n48,7\nhere,7\n", "line 3"),
        ("a.csv", "lat,lon\n148,7\n", "line 2: 148.0, 7.0 is no point"),
        ("a.csv", "lat,lon\n", "lists no places"),
        ("a.csv", "", "latitude and longitude"),
        ("a.shp", "", ".geojson and .csv"),
    ],
)  # fmt: skip
def test_what_is_no_place_is_told_with_its_line(tmp_path, name, text, message):
    with pytest.raises(PlaceError) as caught:
        places_of_file(written(tmp_path, text, name), 50)
    assert message in str(caught.value)


def test_a_missing_file(tmp_path):
    with pytest.raises(StorageError, match=r"none\.csv"):
        places_of_file(tmp_path / "none.csv", 50)


@pytest.mark.parametrize(
    ("ring", "message"),
    [
        (((48.0, 7.0), (48.1, 7.1)), "three corners"),
        (((48.0, 7.0), (48.1, 7.1), (48.2, 7.2)), "no more than a line"),
        (((10.0, 179.0), (10.0, -179.0), (11.0, -179.0)), "180th meridian"),
    ],
)
def test_areas_that_are_none(ring, message):
    with pytest.raises(PlaceError, match=message):
        area("A", ((ring,),))


def test_an_area_that_is_all_hole_says_so():
    ring = ((48.0, 7.0), (48.0, 7.1), (48.1, 7.1), (48.1, 7.0))
    with pytest.raises(PlaceError, match="too thin"):
        next(sample_points(area("Rim", ((ring, ring),))))

"""Everything that can be asked for, against the look-alike services."""

import json

import pytest

from panokit.errors import PlaceError
from panokit.fetch import FetchSettings, fetch
from panokit.fetch.where import areas_of, ids_of, total_wanted
from tests.fetch.conftest import google, panoramax

# The street's panoramas lie on one meridian, 111 m apart.
POINTS = "latitude,longitude\n48.50001,7.7\n48.50201,7.7\n48.4,7.7\n"


def ids(result):
    return sorted(one.capture.id for one in result.stored)


def test_the_picture_nearest_to_each_point_of_a_list(server, tmp_path):
    path = tmp_path / "points.csv"
    path.write_text(POINTS)
    settings = google(server, places=(), area_file=path, count=1)
    result = fetch(settings, tmp_path / "run")
    assert ids(result) == ["pano-16384", "pano-5376"]
    # One picture for each point was wanted, whatever the count says.
    assert result.short == {"points": (2, 3)}
    bodies = [r.json() for r in server.requests if r.path.endswith("/panoIds")]
    assert [(len(body["locations"]), body["radius"]) for body in bodies] == [(3, 50)]


def test_also_where_the_service_lists_boxes(server, tmp_path):
    path = tmp_path / "points.csv"
    path.write_text(POINTS.replace("48.50001", "48.5031"))
    settings = panoramax(server, places=(), area_file=path)
    result = fetch(settings, tmp_path / "run")
    assert ids(result) == ["pano-3328", "pano-5376"]
    for request in server.requests:
        if request.path == "/api/search":
            west, south, east, north = (float(v) for v in request.query["bbox"].split(","))
            assert max(east - west, north - south) < 0.002


def test_only_what_lies_in_a_polygon(server, tmp_path):
    path = tmp_path / "north.geojson"
    corners = [[7.69, 48.5025], [7.71, 48.5025], [7.71, 48.51], [7.69, 48.51], [7.69, 48.5025]]
    path.write_text(json.dumps({"type": "Polygon", "coordinates": [corners]}))
    result = fetch(panoramax(server, places=(), area_file=path), tmp_path / "run")
    assert ids(result) == ["pano-3328"]
    assert result.stored[0].capture.place == "north 1"


def test_pictures_by_id_and_a_place_beside_them(server, tmp_path):
    path = tmp_path / "ids.txt"
    path.write_text("# mine\npano-3328  # the small one\nhttps://example.org/?pic=pano-0000\n")
    settings = panoramax(server, places=(), picture_list=path)
    assert ids_of(settings) == ("pano-3328", "pano-0000")
    result = fetch(settings, tmp_path / "run")
    assert ids(result) == ["pano-3328"]
    assert [(one.item, one.reason) for one in result.rejections] == [
        ("panoramax-pano-0000", "retired")
    ]
    end = {"name": "End", "latitude_deg": 48.5025, "longitude_deg": 7.7, "radius_m": 100}
    both = panoramax(server, places=(end,), count=2, pictures=("pano-3328",))
    assert [area and area.name for area in areas_of(both)] == [None, "End"]
    assert total_wanted(both) == 3
    again = fetch(both, tmp_path / "run")
    assert ids(again) == ["pano-5376"]
    asked = len(server.requests)
    third = fetch(both, tmp_path / "run")
    assert {one.capture.id for one in third.existing} == {"pano-3328", "pano-5376"}
    assert (third.stored, len(server.requests)) == ((), asked)


def test_a_picture_known_to_be_gone_is_not_asked_for_again(server, tmp_path):
    settings = panoramax(server, places=(), pictures=("pano-0000",))
    verdicts = fetch(settings, tmp_path).verdicts
    asked = len(server.requests)
    fetch(settings, tmp_path, known={one.item for one in verdicts})
    assert (len(verdicts), len(server.requests)) == (1, asked)


def test_google_s_panoramas_by_id(server, tmp_path):
    page = "https://www.google.com/maps/@48.5,7.7,3a/data=!3m4!1e1!3m2!1spano-13312!2e0"
    result = fetch(google(server, places=(), pictures=(page,)), tmp_path)
    assert ids(result) == ["pano-13312"]
    assert not [r for r in server.requests if r.path.endswith("/panoIds")]


def test_points_without_a_panorama_near_are_asked_for_in_a_wider_circle(server, tmp_path):
    fetch(google(server, count=4, dry_run=True), tmp_path)
    bodies = [r.json() for r in server.requests if r.path.endswith("/panoIds")]
    assert [body["radius"] for body in bodies[:2]] == [50, 200]
    assert len(bodies[1]["locations"]) < len(bodies[0]["locations"]) == 100


def test_the_distance_to_snap_can_be_said(server, tmp_path):
    fetch(google(server, count=4, dry_run=True, snap_m=30), tmp_path)
    bodies = [r.json() for r in server.requests if r.path.endswith("/panoIds")]
    assert {body["radius"] for body in bodies} == {30}


def test_one_panorama_of_a_drive(server, tmp_path):
    events = []
    settings = panoramax(server, count=4, per_sequence=1, dry_run=True)
    result = fetch(settings, tmp_path, report=events.append)
    assert result.plan.panoramas == 1
    assert result.passed_over["same-sequence"] == 3


def test_one_panorama_of_a_cell(server, tmp_path):
    plan = fetch(google(server, cell_m=5000, dry_run=True), tmp_path).plan
    assert 1 <= plan.panoramas <= 2


@pytest.mark.parametrize("source", ["panoramax", "google-tiles"])
def test_no_place_and_no_picture_is_an_error(source):
    with pytest.raises(PlaceError, match="Say where to look"):
        areas_of(FetchSettings(source=source))


def test_a_folder_needs_no_place():
    settings = FetchSettings(source="folder", folder=".")
    assert (areas_of(settings), total_wanted(settings)) == ([None], None)

"""Mapillary: replies parsed from a stored body, and the whole stage against the look-alike."""

import json
import logging
from datetime import UTC, datetime
from pathlib import Path

import pytest

from panokit.errors import AuthError, ItemError, NetworkError
from panokit.fetch import FetchSettings, PlaceSettings, fetch
from panokit.fetch.cells import Cells
from panokit.fetch.mapillary import (
    LARGEST_CELL_DEG,
    Mapillary,
    is_expired,
    parse_image,
    parse_images,
)
from panokit.http import Client, Policy
from panokit.io import read_capture
from panokit.io.captures import RECORD
from panokit.synthetic.faults import Faults, Trouble
from panokit.synthetic.server import DEFAULT_TOKEN
from tests.fetch.conftest import KEY, panoramax

BODY = (Path(__file__).parent / "data" / "mapillary_images.json").read_bytes()
REAL = json.loads(BODY)["data"][0]


@pytest.fixture
def settings(server, monkeypatch):
    """Makes settings that fetch the street from the look-alike Mapillary."""
    monkeypatch.setenv("MAPILLARY_TOKEN", DEFAULT_TOKEN)
    small = PlaceSettings(name="End", latitude_deg=48.5025, longitude_deg=7.7, radius_m=100)
    defaults = {"source": "mapillary", "places": (small,), "count": 2}
    return lambda **changes: panoramax(server, **(defaults | changes))


@pytest.fixture
def found():
    return {one.capture.id: one for one in parse_images(BODY).items}


def test_only_panoramas_with_a_picture_are_taken(found):
    assert set(found) == {"1386976845208976", "2"}


def test_the_pose_is_what_the_service_computed(found):
    capture = found["1386976845208976"].capture
    # What the service itself calls computed_compass_angle; the camera's compass said 43.
    assert capture.heading_deg == pytest.approx(165.86355589155, abs=1e-3)
    assert capture.pitch_deg == pytest.approx(10.97, abs=0.01)
    assert abs(capture.roll_deg) < 20
    assert capture.details["camera_heading_deg"] == pytest.approx(43.37, abs=0.01)


def test_place_and_time(found):
    capture = found["1386976845208976"].capture
    assert (capture.latitude_deg, capture.longitude_deg) == (39.865000210806, 4.1447180519741)
    assert capture.time == datetime(2023, 5, 9, 10, 47, 44, tzinfo=UTC)
    assert (capture.width_px, capture.height_px, capture.elevation_m) == (5760, 2880, 48.419)
    assert capture.details["sequence"] == "3bVlGmkTzsEOeK1BHvXuLq"


def test_the_license_asks_for_the_same_license(found):
    terms = found["1386976845208976"].capture.license
    assert (terms.id, terms.share_alike, terms.train) == ("CC-BY-SA-4.0", True, True)
    assert "@trekviewhq on Mapillary" in terms.attribution
    assert "pKey=1386976845208976" in terms.attribution


def test_what_is_missing_is_told_or_made_up_for(found):
    one = found["2"]
    # No rotation: the heading alone, and pitch and roll are not known.
    assert (one.capture.heading_deg, one.capture.pitch_deg, one.capture.roll_deg) == (
        10.5, None, None,
    )  # fmt: skip
    assert one.address.endswith("two?oh=00_c&oe=65FA9E45")
    assert one.capture.details["reduced_to_px"] == 2048
    assert one.capture.width_px == 5760


def test_signed_addresses_are_not_kept(found):
    assert "oh=" not in json.dumps(found["1386976845208976"].raw)
    assert found["1386976845208976"].raw["atomic_scale"] == REAL["atomic_scale"]


def test_a_record_that_is_not_as_it_should_be_is_told(caplog):
    with caplog.at_level(logging.WARNING):
        parse_images(BODY)
    assert "KeyError('geometry')" in caplog.text


def test_a_full_list_may_not_be_all():
    many = json.dumps({"data": [REAL] * 2000}).encode()
    assert parse_images(BODY).is_complete
    assert not parse_images(many).is_complete


@pytest.mark.parametrize("body", [b"[]", b'{"error": 1}', b"null"])
def test_another_service_is_not_taken_for_mapillary(body):
    with pytest.raises(NetworkError, match="Mapillary"):
        parse_images(body)


def test_a_level_camera_that_faces_north():
    capture = parse_image(REAL | {"computed_rotation": [1.5707963267948966, 0, 0]}).capture
    assert (capture.heading_deg, capture.pitch_deg, capture.roll_deg) == pytest.approx((0, 0, 0))


def test_an_address_ends_at_its_last_second():
    address = "https://scontent.example.org/x.jpg?oh=1&oe=65FA9E45"
    assert is_expired(address, 0x65FA9E45)
    assert not is_expired(address, 0x65FA9E44)
    assert not is_expired("https://scontent.example.org/x.jpg", 2e9)


def test_the_street_is_stored_whole(server, settings, tmp_path):
    result = fetch(settings(), tmp_path)
    assert {one.capture.id for one in result.stored} == {
        "pano-5376",
        "pano-3328",
    }
    for one in result.stored:
        stored = read_capture(one.folder)
        assert stored.read("image.jpg").startswith(b"\xff\xd8")
        # As the look-alike's pictures were taken.
        assert stored.capture.heading_deg == pytest.approx(350.0, abs=1e-4)
        assert stored.capture.pitch_deg == pytest.approx(1.5, abs=1e-4)
        assert stored.capture.roll_deg == pytest.approx(-2.0, abs=1e-4)
        text = (one.folder / RECORD).read_text()
        assert "oh=" not in text
        assert DEFAULT_TOKEN not in text
    assert server.violations == []
    asked = [r for r in server.requests if r.path == "/images"]
    assert asked
    for request in asked:
        west, south, east, north = (float(part) for part in request.query["bbox"].split(","))
        assert max(east - west, north - south) <= LARGEST_CELL_DEG + 1e-6
        assert "access_token" not in request.query


def test_addresses_that_have_ended_are_asked_for_again(server, settings, tmp_path):
    server.set_faults(Faults(url_lifetime_s=1.0))
    result = fetch(settings(count=1), tmp_path)
    assert len(result.stored) == 1
    # All of them are within the margin: each is renewed once before it is used.
    assert sum(r.path == "/" + result.stored[0].capture.id for r in server.requests) == 1


def test_the_clock_decides_that(server, settings):
    with Client() as client:
        late = Mapillary(settings(), client, clock=lambda: 4e9)
        (found,) = parse_images(json.dumps({"data": [REAL | {"id": "pano-3328"}]}).encode()).items
        assert late.read(found, "image.jpg").startswith(b"\xff\xd8")
    assert [r.path for r in server.requests if r.port == "api"] == ["/pano-3328"]


def test_a_refused_address_is_renewed_once(server, settings):
    address = server.storage_url + "/m1/v/t6/pano-3328/original.jpg?oh=forged&oe=FFFFFFFF"
    with Client() as client:
        (found,) = parse_images(
            json.dumps(
                {"data": [REAL | {"id": "pano-3328", "thumb_original_url": address}]}
            ).encode()
        ).items
        mapillary = Mapillary(settings(), client)
        assert mapillary.read(found, "image.jpg").startswith(b"\xff\xd8")
        # One that is refused again is not asked for a third time.
        mapillary._new_address = lambda _: address
        with pytest.raises(ItemError) as caught:
            mapillary.read(found, "image.jpg")
    assert caught.value.reason == "forbidden"


@pytest.mark.parametrize("faults", [Faults(dense_box=1), Faults(thinned=True)])
def test_dense_cells_are_cut(server, settings, tmp_path, faults):
    server.set_faults(faults)
    result = fetch(settings(min_distance_m=0), tmp_path)
    assert len(result.stored) == 2
    assert result.requests < 40


def test_boxes_that_are_too_large_are_never_asked_for():
    asked = []

    def search(bbox):
        asked.append(bbox)
        return Mapillary._search(None, bbox)

    # The provider itself is not needed where nothing is asked.
    cells = Cells((7.0, 48.0, 8.0, 49.0), search)
    with pytest.raises(AttributeError):
        cells.around((48.3, 7.3))
    sides = [east - west for west, _, east, _ in asked]
    assert sides[:-1] == [side for side in sides if side > LARGEST_CELL_DEG]
    assert sides[-1] <= LARGEST_CELL_DEG


def test_pictures_by_id(server, settings, tmp_path):
    result = fetch(settings(places=(), pictures=("pano-3328", "pano-1")), tmp_path)
    assert [one.capture.id for one in result.stored] == ["pano-3328"]
    (gone,) = result.rejections
    assert (gone.item, gone.reason) == ("mapillary-pano-1", "retired")
    assert result.verdicts == (gone,)


def test_the_token_is_nowhere(server, settings, tmp_path, caplog, capfd):
    caplog.set_level(logging.DEBUG)
    logging.getLogger("panokit.synthetic").setLevel(logging.INFO)
    server.set_faults(
        Faults(
            troubles=[
                Trouble(kind=kind, path=path)
                for kind in ("429", "500", "html")
                for path in ("/images", "/m1/")
            ],
            url_lifetime_s=1.0,
        )
    )
    with Client(Policy(first_delay_s=0.01, rate_per_s=1000)) as client:
        result = fetch(settings(count=1), tmp_path, client=client)
    printed = capfd.readouterr()
    told = repr(result) + caplog.text + printed.out + printed.err
    written = b"".join(path.read_bytes() for path in tmp_path.rglob("*") if path.is_file())
    assert len(result.stored) == 1
    assert DEFAULT_TOKEN not in told
    assert DEFAULT_TOKEN.encode() not in written
    # Signed addresses are credentials as well: none is written down.
    assert b"oh=" not in written
    assert server.violations == []


def test_a_token_is_needed(monkeypatch):
    monkeypatch.delenv("MAPILLARY_TOKEN", raising=False)
    with Client() as client, pytest.raises(AuthError, match="MAPILLARY_TOKEN"):
        Mapillary(FetchSettings(source="mapillary"), client)


def test_a_wrong_token_is_told_at_once(server, settings, tmp_path, monkeypatch):
    monkeypatch.setenv("MAPILLARY_TOKEN", "MLY|" + KEY)
    with Client(Policy(first_delay_s=0.01)) as client, pytest.raises(AuthError) as caught:
        fetch(settings(), tmp_path, client=client)
    assert KEY not in str(caught.value)
    assert len(server.requests) == 1

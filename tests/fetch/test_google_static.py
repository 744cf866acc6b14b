"""The Static API: views that cover the sphere, signatures, the grey picture, the records."""

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from panokit.capture import TimePrecision
from panokit.errors import (
    AuthError,
    ImageError,
    ItemError,
    LicenseError,
    NetworkError,
    QuotaError,
    SettingsError,
)
from panokit.fetch import FetchSettings, fetch
from panokit.fetch.google_static import (
    MARKS_PX,
    NO_IMAGERY_RGB,
    GoogleStatic,
    check_status,
    check_view,
    parse_metadata,
    plan_views,
    sign,
)
from panokit.frames import azimuth_elevation_from_direction
from panokit.http import Client
from panokit.io import read_capture
from panokit.io.images import decode_image, encode_jpeg
from panokit.stitch import stitch
from panokit.synthetic.faults import Faults
from panokit.synthetic.google_static import SIGNING_SECRET
from tests.fetch.conftest import google

BODY = (Path(__file__).parent / "data" / "google_static_metadata.json").read_bytes()
VIEWS = plan_views(75.0)


@pytest.fixture
def static(server):
    """Makes settings that fetch the street from the look-alike Static API, in few views."""
    return lambda **changes: google(
        server, **({"source": "google-static", "view_fov_deg": 100.0, "count": 1} | changes)
    )


def directions(count=4000):
    """Even directions on the sphere (the golden spiral)."""
    n = np.arange(count) + 0.5
    up, turn = 1 - 2 * n / count, n * np.pi * (3 - 5**0.5)
    level = np.sqrt(1 - up**2)
    return np.stack([level * np.sin(turn), up, -level * np.cos(turn)], axis=-1)


def times_seen(views):
    """How many views show each direction outside of their masks."""
    rays = directions()
    seen = np.zeros(len(rays), int)
    for view in views:
        x, y, z = (rays @ view.world_from_view.matrix).T
        focal_px = view.width_px / 2 / np.tan(np.deg2rad(view.fov_deg / 2))
        in_front = z < -1e-6
        depth = np.where(in_front, -z, 1.0)
        column = view.width_px / 2 + focal_px * x / depth
        row = view.height_px / 2 - focal_px * y / depth
        inside = in_front & (column >= 0) & (column < view.width_px)
        inside &= (row >= 0) & (row < view.height_px)
        for left, top, right, bottom in view.masked_px:
            inside &= ~((left <= column) & (column < right) & (top <= row) & (row < bottom))
        seen += inside
    return seen


@pytest.mark.parametrize("fov_deg", range(50, 101, 2))
def test_every_direction_is_seen_beside_the_marks(fov_deg):
    seen = times_seen(plan_views(float(fov_deg)))
    assert seen.min() >= 1
    # Most is in two views or more, for gains to be found and seams to be hidden.
    assert (seen >= 2).mean() > 0.85


def test_the_usual_plan_has_22_views():
    assert len(VIEWS) == 22
    assert len({view.name for view in VIEWS}) == 22
    assert {view.masked_px for view in VIEWS} == {(MARKS_PX,)}
    assert len(plan_views(50.0)) > 40
    assert len(plan_views(100.0)) < 20


def test_a_view_s_pose():
    view = next(view for view in VIEWS if view.heading_deg == 90 and view.pitch_deg == 0)
    assert view.world_from_view.apply(np.array([0.0, 0, -1])) == pytest.approx([1, 0, 0], abs=1e-9)
    up = next(view for view in VIEWS if view.pitch_deg == 90)
    assert up.world_from_view.apply(np.array([0.0, 0, -1])) == pytest.approx([0, 1, 0], abs=1e-9)


def test_the_vendor_s_own_signature():
    path = "/maps/api/geocode/json?address=New+York&client=clientID"
    assert sign(path, SIGNING_SECRET) == "chaRF2hTJKOScPr-RQCEhZbSzIE="


@pytest.mark.parametrize("secret", ["no base64!", "abc"])
def test_a_secret_that_is_none(secret):
    with pytest.raises(SettingsError, match="GOOGLE_MAPS_SIGNING_SECRET") as caught:
        sign("/x", secret)
    assert secret not in str(caught.value)


def test_metadata():
    found = parse_metadata(BODY, VIEWS)
    capture = found.capture
    assert (capture.id, capture.time) == (
        "vPnURflnc8AZu5NMLYRddw",
        datetime(2014, 4, 1, tzinfo=UTC),
    )
    assert capture.time_precision is TimePrecision.MONTH
    assert not (capture.license.store or capture.license.derive or capture.license.train)
    assert "do not let you store them" in capture.details["terms"]
    assert found.files == tuple(view.name for view in VIEWS)


@pytest.mark.parametrize("status", ["ZERO_RESULTS", "NOT_FOUND"])
def test_no_panorama_is_no_error(status):
    assert parse_metadata(f'{{"status": "{status}"}}'.encode(), VIEWS) is None


@pytest.mark.parametrize(
    ("body", "error"),
    [
        (b'{"status": "OVER_QUERY_LIMIT"}', QuotaError),
        (b'{"status": "REQUEST_DENIED", "error_message": "The key is invalid."}', AuthError),
        (b'{"status": "INVALID_REQUEST"}', NetworkError),
        (b'{"status": "OK"}', NetworkError),
        (b"{}", NetworkError),
        (b"[]", NetworkError),
    ],
)
def test_errors_come_with_status_200(body, error):
    with pytest.raises(error):
        parse_metadata(body, VIEWS)


def test_a_passing_error_is_asked_again():
    check_status(BODY)
    with pytest.raises(ItemError):
        check_status(b'{"status": "UNKNOWN_ERROR"}')


def test_the_grey_picture_is_no_view():
    grey = np.full((640, 640, 3), NO_IMAGERY_RGB, np.uint8)
    grey[300:320, 200:440] = 120  # the words in the middle
    with pytest.raises(ImageError) as caught:
        check_view(encode_jpeg(grey), VIEWS[0], "view")
    assert caught.value.reason == "no-imagery"
    fog = np.full((640, 640, 3), (200, 205, 210), np.uint8)
    check_view(encode_jpeg(fog), VIEWS[0], "view")
    with pytest.raises(ImageError, match="320x320"):
        check_view(encode_jpeg(fog[:320, :320]), VIEWS[0], "view")


def test_the_record_holds_all_that_a_stitch_needs(server, static, tmp_path):
    (one,) = fetch(static(), tmp_path).stored
    stored = read_capture(one.folder)
    assert stored.grid is None
    assert stored.views == plan_views(100.0)
    assert set(stored.files) == {view.name for view in stored.views}
    for view in stored.views:
        assert decode_image(stored.read(view.name), what=view.name).shape == (640, 640, 3)
        assert view.masked_px == (MARKS_PX,)
    asked = [r for r in server.requests if r.path == "/maps/api/streetview"]
    assert {(float(r.query["heading"]), float(r.query["pitch"])) for r in asked} == {
        (view.heading_deg, view.pitch_deg) for view in stored.views
    }
    panorama = stitch(stored)
    assert panorama.pixels.shape[1] == 2 * panorama.pixels.shape[0]
    assert panorama.valid is None or panorama.valid.mean() > 0.99


def test_each_view_shows_what_its_pose_says(server, pictures, static, tmp_path):
    (one,) = fetch(static(), tmp_path).stored
    served = next(p for p in pictures if p.capture.id == one.capture.id)
    panorama = decode_image(served.image.read_bytes(), what="served").astype(float)
    height, width = panorama.shape[:2]
    apart = []
    for view in one.views:
        ahead = view.world_from_view.apply(np.array([0.0, 0, -1]))
        seen = served.capture.world_from_camera.inverse.apply(ahead)
        azimuth, elevation = azimuth_elevation_from_direction(seen)
        column = round((azimuth / (2 * np.pi) + 0.5) * width) % width
        row = min(round((0.5 - elevation / np.pi) * height), height - 1)
        middle = decode_image(one.read(view.name), what=view.name)[318:322, 318:322].astype(float)
        apart.append(np.abs(middle.mean(axis=(0, 1)) - panorama[row, column]).max())
    # The pattern has edges, where a pixel's width decides: the median does not see them.
    assert np.median(apart) < 4


def test_requests_are_signed_where_there_is_a_secret(server, static, tmp_path, monkeypatch):
    server.set_faults(Faults(signature_required=True))
    with pytest.raises(AuthError):
        fetch(static(), tmp_path / "unsigned")
    monkeypatch.setenv("GOOGLE_MAPS_SIGNING_SECRET", SIGNING_SECRET)
    (one,) = fetch(static(), tmp_path / "signed").stored
    records = [path.read_bytes() for path in one.folder.rglob("*") if path.is_file()]
    assert not [record for record in records if SIGNING_SECRET.encode() in record]
    assert not [record for record in records if b"signature" in record]


def test_a_run_goes_on_where_it_stopped(server, static, tmp_path):
    fetch(static(), tmp_path)
    asked = len(server.requests)
    again = fetch(static(), tmp_path)
    assert (len(again.existing), len(server.requests)) == (1, asked)


def test_money(server, static, tmp_path):
    plan = fetch(static(count=4, dry_run=True), tmp_path).plan
    views = len(plan_views(100.0))
    assert (plan.panoramas, plan.files, plan.unit) == (4, 4 * views, "view")
    assert plan.cost_usd == pytest.approx(4 * views * 0.007)
    assert not [r for r in server.requests if r.path == "/maps/api/streetview"]
    with pytest.raises(QuotaError, match="USD"):
        fetch(static(count=2, max_cost_usd=1.5 * views * 0.007), tmp_path)
    assert len(list((tmp_path / "captures").iterdir())) == 1


def test_pictures_by_id(server, static, tmp_path):
    result = fetch(static(places=(), pictures=("pano-3328", "pano-1")), tmp_path)
    assert [one.capture.id for one in result.stored] == ["pano-3328"]
    assert [(one.item, one.reason) for one in result.rejections] == [
        ("google-static-pano-1", "retired")
    ]


def test_terms_come_first(monkeypatch):
    with Client() as client, pytest.raises(LicenseError, match="accept-terms google"):
        GoogleStatic(FetchSettings(source="google-static"), client)


def test_a_masked_view_survives_its_record():
    view = replace(VIEWS[3], roll_deg=1.5)
    assert type(view).from_json(view.to_json()) == view

"""Google Map Tiles replies, parsed from stored bodies."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from panokit.capture import TileGrid, TimePrecision
from panokit.errors import AuthError, ImageError, ItemError, LicenseError, NetworkError
from panokit.fetch import FetchSettings
from panokit.fetch.google_tiles import GoogleTiles, check_tile, parse_ids, parse_metadata
from panokit.http import Client
from panokit.io.images import encode_jpeg
from tests.fetch.conftest import picture_bytes

DATA = Path(__file__).parent / "data"
GRID = TileGrid(width_px=3328, height_px=1664, tile_width_px=512, tile_height_px=512, zoom=3)


def parsed(name: str, **settings: object):
    return parse_metadata((DATA / name).read_bytes(), FetchSettings.model_validate(settings))


def test_metadata():
    capture = parsed("google_metadata.json").capture
    assert capture.id == "GJ99KitLZxEpsY4Yx9PV2g"
    assert capture.heading_deg == pytest.approx(94.345398)
    # A tilt of 90 is level, and the roll comes in [0, 360).
    assert capture.pitch_deg == pytest.approx(-1.60348)
    assert capture.roll_deg == pytest.approx(-5.53015)
    assert capture.time == datetime(2023, 10, 1, tzinfo=UTC)
    assert capture.time_precision is TimePrecision.MONTH
    assert capture.details["imagery_type"] == "outdoor"
    assert (capture.width_px, capture.height_px) == (13312, 6656)


def test_the_terms_permit_nothing_and_the_copyright_is_named():
    terms = parsed("google_metadata.json").capture.license
    assert terms.id == "google-maps-platform"
    assert not (terms.store or terms.derive or terms.train)
    assert "© 2023 Google" in terms.attribution


def test_the_size_is_that_of_the_picture_not_of_its_tiles():
    found = parsed("google_metadata.json", zoom=3)
    assert found.grid == GRID
    assert len(found.files) == 7 * 4
    assert found.files[:2] == ("tiles/0_0.jpg", "tiles/1_0.jpg")


def test_the_zoom_follows_from_the_width_wanted():
    assert parsed("google_metadata.json", width_px=4096).grid.zoom == 4
    assert parsed("google_metadata.json", width_px=3000).grid.zoom == 3


def test_everything_but_id_and_size_may_be_absent():
    found = parsed("google_metadata_sparse.json", zoom=5)
    assert found.grid.zoom == 3
    assert found.position_deg is None
    assert (found.capture.heading_deg, found.capture.time) == (None, None)


@pytest.mark.parametrize("body", [b"{}", b'{"panoId": "x", "imageWidth": 0, "imageHeight": 0}'])
def test_metadata_without_a_size_is_a_bad_item(body):
    with pytest.raises(ItemError) as caught:
        parse_metadata(body, FetchSettings())
    assert caught.value.reason == "bad-metadata"


def test_ids_come_in_the_order_of_the_points():
    one, other = "jGaYvr31o-KsarHZtXbc5w", "m9Kxq1YiydHXKrVLtggrFA"
    body = (DATA / "google_pano_ids.json").read_bytes()
    assert parse_ids(body, 4) == [one, other, "", one]
    assert parse_ids(b"{}", 2) == ["", ""]


@pytest.mark.parametrize("body", [b'{"panoIds": ["x"]}', b"[]", b'{"error": "no"}'])
def test_a_reply_that_does_not_fit_the_points_is_none(body):
    with pytest.raises(NetworkError, match="2 ids"):
        parse_ids(body, 2)


def test_a_tile_may_be_full_cropped_or_small_but_not_broken():
    for size in ((512, 512), (128, 256), (256, 256)):
        check_tile(encode_jpeg(np.zeros((*size, 3), np.uint8)), GRID, "tile")
    with pytest.raises(ImageError, match="larger than a tile"):
        check_tile(picture_bytes(1024), GRID, "tile")
    with pytest.raises(ImageError, match="ends early"):
        check_tile(picture_bytes(256)[:-50], GRID, "tile")


def test_terms_and_key_come_first(monkeypatch):
    monkeypatch.delenv("GOOGLE_MAPS_API_KEY", raising=False)
    with Client() as client:
        with pytest.raises(LicenseError, match="accept-terms google"):
            GoogleTiles(FetchSettings(source="google-tiles"), client)
        with pytest.raises(AuthError, match="GOOGLE_MAPS_API_KEY"):
            GoogleTiles(FetchSettings(source="google-tiles", accept_terms=("google",)), client)

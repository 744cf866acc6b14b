"""Panoramax replies, parsed from stored bodies."""

import json
import logging
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from panokit.errors import ItemError, NetworkError
from panokit.fetch.jpeg import check_sphere
from panokit.fetch.panoramax import parse_search
from panokit.io.images import encode_jpeg
from tests.fetch.conftest import picture_bytes

BODY = (Path(__file__).parent / "data" / "panoramax_search.json").read_bytes()
URL = "https://panoramax.example.org/api/search"


@pytest.fixture
def found():
    return {one.capture.id[:8]: one for one in parse_search(BODY, URL).items}


def test_only_whole_ready_360_pictures_are_taken(found):
    assert set(found) == {"c41b9734", "0b6f2c1e"}


def test_an_item_of_an_older_server(found):
    one = found["c41b9734"]
    capture = one.capture
    assert one.position_deg == (48.50179, 7.731916)
    assert capture.time == datetime(2022, 5, 30, 17, 23, 19, 423000, tzinfo=UTC)
    assert capture.heading_deg == 3
    assert capture.pitch_deg is None
    assert capture.roll_deg is None
    # From tiles of 687.5 px: the picture is larger than the tiles that are served.
    assert (capture.width_px, capture.height_px) == (11000, 5500)
    assert one.address.startswith("https://storage.example.org/")
    assert one.bytes == 4914653
    assert one.files == ("image.jpg",)


def test_an_item_of_a_newer_server(found):
    capture = found["0b6f2c1e"].capture
    assert (capture.heading_deg, capture.pitch_deg, capture.roll_deg) == (271.5, -1.25, -1.5)
    assert (capture.width_px, capture.height_px) == (5760, 2880)
    assert capture.details["local_time"] == "2025-07-01T11:00:00+01:00"
    assert found["0b6f2c1e"].address == "https://panoramax.example.org/api/pictures/0b6f2c1e/hd.jpg"


def test_license_and_attribution_come_with_every_picture(found):
    old, new = found["c41b9734"].capture.license, found["0b6f2c1e"].capture.license
    assert (old.id, old.store, old.train, old.share_alike) == ("etalab-2.0", True, True, False)
    assert "strasbourg" in old.attribution
    assert (new.id, new.share_alike) == ("CC-BY-SA-4.0", True)
    assert new.attribution == "a mapper via Panoramax (CC-BY-SA-4.0)"


def test_a_picture_without_a_license_permits_nothing():
    item = json.loads(BODY)["features"][0]
    del item["properties"]["license"]
    (one,) = parse_search(json.dumps({"features": [item]}).encode(), URL).items
    terms = one.capture.license
    assert (terms.id, terms.store, terms.derive, terms.train) == ("unknown", False, False, False)


def test_the_provider_s_own_words_are_kept(found):
    assert found["c41b9734"].raw == json.loads(BODY)["features"][0]


def test_an_item_that_is_not_as_it_should_be_is_told(caplog):
    with caplog.at_level(logging.WARNING):
        parse_search(BODY, URL)
    assert "KeyError('geometry')" in caplog.text


def test_a_full_page_is_known_not_to_be_all():
    item = json.loads(BODY)["features"][0]
    assert parse_search(json.dumps({"features": [item] * 99}).encode(), URL).is_complete
    assert not parse_search(json.dumps({"features": [item] * 100}).encode(), URL).is_complete


@pytest.mark.parametrize("body", [b"[]", b'{"type": "Catalog"}', b"null"])
def test_another_service_is_not_taken_for_panoramax(body):
    with pytest.raises(NetworkError, match="Panoramax server"):
        parse_search(body, URL)


def test_a_picture_must_be_a_whole_sphere():
    check_sphere(picture_bytes(64), "it")
    with pytest.raises(ItemError) as caught:
        check_sphere(encode_jpeg(np.zeros((32, 48, 3), np.uint8)), "it")
    assert caught.value.reason == "not-360"

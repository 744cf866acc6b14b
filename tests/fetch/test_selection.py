"""Which pictures are wanted of those that a provider has."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from panokit.capture import Capture, License, TimePrecision, license_from_spdx
from panokit.errors import Rejection
from panokit.fetch import FetchSettings
from panokit.fetch.geodesy import offset
from panokit.fetch.places import disc
from panokit.fetch.provider import Found
from panokit.fetch.selection import Selection
from panokit.io.captures import StoredCapture

CENTER = (48.5, 7.7)
PLACE = disc("P", *CENTER, 500)


def picture(name: str, east_m: float = 0.0, **changes) -> Found:
    latitude, longitude = offset(CENTER, east_m, 0)
    values = {
        "provider": "t",
        "id": name,
        "license": license_from_spdx("CC-BY-4.0", "me"),
        "latitude_deg": latitude,
        "longitude_deg": longitude,
    }
    return Found(capture=Capture(**(values | changes)))


class Shelf:
    """A provider that offers the same things at every call."""

    usd_per_file = 0.0

    def __init__(self, *things, may_store=False):
        self.things, self.may_store, self.asked = things, may_store, 0

    def find(self, place, points):
        self.asked += 1
        return iter(self.things)

    def read(self, found, name):
        raise NotImplementedError


def select(shelf, place=PLACE, on_disk=None, known=(), **settings):
    selection = Selection(FetchSettings(**settings), place, on_disk or {}, known)
    chosen = []
    for one in selection.candidates(shelf):
        chosen.append(one)
        if len(chosen) > 20:
            break
    names = [c.item if isinstance(c, Rejection) else c.capture.id for c in chosen]
    return names, dict(selection.passed_over)


def test_pictures_keep_their_distance():
    shelf = Shelf(picture("a", 0), picture("b", 10), picture("c", 40))
    names, passed_over = select(shelf, min_distance_m=25)
    assert names == ["a", "c"]
    assert passed_over["too-close"] > 0


def test_also_from_those_on_disk():
    stored = StoredCapture(folder=Path("x"), capture=picture("a").capture, files={})
    names, _ = select(Shelf(picture("b", 10), picture("c", 40)), on_disk={"t-a": stored})
    assert names == ["c"]


@pytest.mark.parametrize(
    ("found", "reason"),
    [
        (picture("far", 600), "outside"),
        (picture("nowhere", latitude_deg=None), "outside"),
        (picture("in", details={"imagery_type": "indoor"}), "indoor"),
        (picture("closed", license=License(id="proprietary", attribution="x")), "no-license"),
    ],
)
def test_what_is_not_wanted_is_counted_by_reason(found, reason):
    names, passed_over = select(Shelf(found))
    assert names == []
    assert set(passed_over) == {reason}


def test_indoor_panoramas_are_taken_where_they_are_wanted():
    shelf = Shelf(picture("in", details={"imagery_type": "indoor"}))
    assert select(shelf, indoor=True)[0] == ["in"]


def test_consent_stands_in_for_a_license():
    closed = picture("closed", license=License(id="google-maps-platform", attribution="Google"))
    assert select(Shelf(closed, may_store=True))[0] == ["closed"]


def test_known_and_stored_pictures_are_not_offered_again():
    stored = StoredCapture(folder=Path("x"), capture=picture("a").capture, files={})
    names, passed_over = select(
        Shelf(picture("a"), picture("b", 100), picture("c", 200)),
        on_disk={"t-a": stored},
        known={"t-b"},
    )
    assert names == ["c"]
    assert passed_over["existing"] >= 1
    assert passed_over["known"] >= 1


def test_a_rejection_of_a_known_picture_is_not_told_again():
    dead = Rejection(item="t-dead", stage="fetch", reason="retired", message="gone")
    assert "t-dead" in select(Shelf(dead))[0]
    assert select(Shelf(dead), known={"t-dead"})[0] == []


def on(*date, precision=TimePrecision.SECOND):
    return {"time": datetime(*date, tzinfo=UTC), "time_precision": precision}


@pytest.mark.parametrize(
    ("time", "wanted"),
    [
        (on(2024, 5, 6, 12), True),
        (on(2024, 5, 5, 23), False),
        (on(2024, 7, 1), False),
        ({}, False),
        # May is all that is known: it may be a day of the span.
        (on(2024, 5, 1, precision=TimePrecision.MONTH), True),
        (on(2024, 4, 1, precision=TimePrecision.MONTH), False),
    ],
)
def test_dates(time, wanted):
    names, _ = select(Shelf(picture("a", **time)), date_from="2024-05-06", date_to="2024-06-30")
    assert names == (["a"] if wanted else [])


def test_without_a_place_everything_is_taken_once():
    shelf = Shelf(picture("a"), picture("b"))
    assert select(shelf, place=None)[0] == ["a", "b"]
    assert shelf.asked == 1


def test_a_place_without_pictures_comes_to_an_end():
    shelf = Shelf()
    assert select(shelf)[0] == []
    assert shelf.asked == 3

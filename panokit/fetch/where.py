"""What the settings say of where to look: areas, and pictures by their ids."""

from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

from panokit.capture import capture_key
from panokit.errors import PlaceError
from panokit.fetch.cities import find_city
from panokit.fetch.picture_ids import picture_ids
from panokit.fetch.place_files import places_of_file
from panokit.fetch.places import Place, box, check_point, disc
from panokit.fetch.settings import FetchSettings
from panokit.io.files import read_bytes

DEFAULT_SNAP_M = 50.0


def areas_of(settings: FetchSettings) -> list[Place | None]:
    """Where to look, in order; None stands for pictures that are named one by one.

    A source of pictures without places (a folder) is one None.

    Raises:
        PlaceError: If nothing is asked for.
    """
    if settings.source == "folder":
        return [None]
    by_name: list[Place | None] = [None] if ids_of(settings) else []
    if by_name and not _asks_for_places(settings):
        return by_name
    return [*by_name, *places_of(settings)]


def ids_of(settings: FetchSettings) -> tuple[str, ...]:
    """The ids of the pictures that are asked for by name, each once."""
    texts = (*settings.pictures, *_listed(settings.picture_list, " #"))
    if not texts:
        return ()
    return picture_ids(settings.source, texts)


def keys_of(settings: FetchSettings) -> list[str]:
    """The capture keys of the pictures that are asked for by id."""
    return [capture_key(settings.source, id) for id in ids_of(settings)]


def without_pictures(settings: FetchSettings, is_settled: Callable[[str], bool]) -> FetchSettings:
    """The same settings, without the pictures whose capture key is settled."""
    ids = ids_of(settings)
    left = tuple(id for id in ids if not is_settled(capture_key(settings.source, id)))
    return settings.model_copy(update={"pictures": left, "picture_list": None})


def wanted_of(area: Place | None, settings: FetchSettings) -> int | None:
    """How many pictures are wanted of an area: one for each point of a list; None for all."""
    if area is None:
        return None
    return len(area.points) or settings.count


def total_wanted(settings: FetchSettings) -> int | None:
    """How many pictures are wanted in all, None where nobody knows before."""
    if settings.source == "folder":
        return None
    total = len(ids_of(settings))
    return total + sum(wanted_of(area, settings) or 0 for area in areas_of(settings))


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
    snap_m = settings.snap_m or DEFAULT_SNAP_M
    if settings.area_file is not None:
        found += places_of_file(settings.area_file, snap_m)
    if settings.point is not None:
        point = check_point(*settings.point)
        name = f"{point[0]:.4f} {point[1]:.4f}"
        found.append(disc(name, *point, settings.radius_m or 1000.0))
    if settings.bbox is not None:
        found.append(box(" ".join(f"{value:.4f}" for value in settings.bbox), settings.bbox))
    if not found:
        raise PlaceError(
            'Say where to look: --city "Bristol, GB", or cities = ["Bristol, GB"] in a '
            "pipeline's [fetch]."
        )
    (name, times), *_ = Counter(place.name for place in found).most_common(1)
    if times > 1:
        raise PlaceError(f"Two places are called {name!r}; give one of them another name.")
    return found


def _asks_for_places(settings: FetchSettings) -> bool:
    asked = (settings.cities, settings.city_list, settings.places, settings.area_file)
    return any(asked) or settings.point is not None or settings.bbox is not None


def _listed(path: Path | None, comment: str = "#") -> Iterator[str]:
    """The lines of a list, without comments; an address may have a # in it."""
    if path is not None:
        for line in read_bytes(path).decode("utf-8", "replace").splitlines():
            name = f" {line}".partition(comment)[0].strip()
            if name:
                yield name

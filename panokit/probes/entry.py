"""One line of the library's list, and which lines a filter lets pass."""

from collections.abc import Callable
from datetime import UTC
from itertools import product
from typing import Any, NamedTuple

from panokit.probes.probe import Probe
from panokit.probes.settings import ProbeFilter


class Entry(NamedTuple):
    """One line of the library's list; each field is a column of the index.

    A named tuple, not a dataclass: ten thousand of them are made whenever a library is listed.

    Attributes:
        id: Of the probe.
        name: What it was called when it was added.
        category: The kind of scene, "" where it is not known.
        kind: "native", "lifted" or "synthetic".
        place: The city or area, "" for none.
        latitude_deg: North positive, or None.
        longitude_deg: East positive, or None.
        time: When it was taken, in UTC, as "2024-05-06T07:08:09Z"; "" where it is not known.
        provider: Of the picture, "" for none.
        license: Its id, "unknown" where it is not known.
        attribution: The line to show with the map.
        verdict: Of QA: "pass" or "fail".
        plausibility: How far QA found it from what captured maps look like, or None.
        width_px: Of the map.
        dynamic_range_stops: From the median to the peak, or None.
        top_share: The share of the energy in the brightest 0.1 % of the sphere, or None.
        sun_azimuth_deg: Where the sun is, clockwise from the map's center, or None.
        sun_elevation_deg: How high it is, or None.
        tags: Words to find it by, with a comma before and after each; "" for none.
        has_sun: Whether the sun is in it, as far as anything tells.
        in_place: Whether its map lies outside the library.
        storable: Whether the license lets a copy be kept.
        derivable: Whether it lets new works be made.
        trainable: Whether it lets models be trained.
    """

    id: str
    name: str
    category: str
    kind: str
    place: str
    latitude_deg: float | None
    longitude_deg: float | None
    time: str
    provider: str
    license: str
    attribution: str
    verdict: str
    plausibility: float | None
    width_px: int
    dynamic_range_stops: float | None
    top_share: float | None
    sun_azimuth_deg: float | None
    sun_elevation_deg: float | None
    tags: str
    has_sun: bool
    in_place: bool
    storable: bool
    derivable: bool
    trainable: bool

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`; the tags as a list."""
        return {**self._asdict(), "tags": [tag for tag in self.tags.split(",") if tag]}


COLUMNS = Entry._fields
_FIRST_FLAG = COLUMNS.index("has_sun")
# All that flags can be, as numbers and as flags: looking up is faster than converting.
_FLAGS = {
    flags: tuple(map(bool, flags)) for flags in product((0, 1), repeat=len(COLUMNS) - _FIRST_FLAG)
}

# Field of the filter -> condition with one question mark for each value of it.
_CONDITIONS = {
    "name": "name LIKE '%' || ? || '%' ESCAPE '\\'",
    "category": "category LIKE ? || '%' ESCAPE '\\'",
    "kind": "kind = ?",
    "place": "place = ? COLLATE NOCASE",
    "date_from": "time >= ?",
    # A time begins with its day; what follows sorts before the next letter.
    "date_to": "time != '' AND time < ? || '~'",
    "provider": "provider = ? COLLATE NOCASE",
    "license": "license = ? COLLATE NOCASE",
    "trainable": "trainable = ?",
    "derivable": "derivable = ?",
    "storable": "storable = ?",
    "verdict": "verdict = ?",
    "plausibility_max": "plausibility <= ?",
    "dynamic_range_min_stops": "dynamic_range_stops >= ?",
    "has_sun": "has_sun = ?",
}


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace("%", "\\%").replace("_", "\\_")


_VALUES: dict[str, Callable[[Any], Any]] = {
    "name": _escaped,
    "category": _escaped,
    "date_from": str,
    "date_to": str,
}


def entry_of(probe: Probe) -> Entry:
    """The line of a probe in the list."""
    values = probe.report.values
    capture = probe.capture
    sun = probe.sun or {}
    time = capture.time if capture else None
    return Entry(
        id=probe.id,
        name=probe.name,
        category=probe.category,
        kind=probe.kind,
        place=capture.place if capture else "",
        latitude_deg=capture.latitude_deg if capture else None,
        longitude_deg=capture.longitude_deg if capture else None,
        time=time.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ") if time else "",
        provider=capture.provider if capture else "",
        license=probe.license.id,
        attribution=probe.license.attribution,
        verdict=str(probe.report.verdict),
        plausibility=values.get("plausibility"),
        width_px=probe.width_px,
        dynamic_range_stops=values.get("dynamic-range"),
        top_share=values.get("top-share"),
        sun_azimuth_deg=sun.get("azimuth_deg"),
        sun_elevation_deg=sun.get("elevation_deg"),
        tags="".join(f",{tag.replace(',', ' ')}" for tag in probe.tags) + "," * bool(probe.tags),
        has_sun=bool(sun),
        in_place=probe.source is not None,
        storable=probe.license.store,
        derivable=probe.license.derive,
        trainable=probe.license.train,
    )


def entry_from_row(row: tuple[Any, ...]) -> Entry:
    """The entry of a row of the index, whose flags are 0 and 1."""
    return Entry._make(row[:_FIRST_FLAG] + _FLAGS[row[_FIRST_FLAG:]])


def query_of(wanted: ProbeFilter) -> tuple[str, list[Any]]:
    """The SQL condition of a filter, and the values for its question marks."""
    conditions, values = ["1"], []
    for name, condition in _CONDITIONS.items():
        value = getattr(wanted, name)
        if value is not None:
            conditions.append(condition)
            values.append(_VALUES.get(name, lambda same: same)(value))
    for tag in wanted.tags:
        conditions.append("tags LIKE '%,' || ? || ',%' ESCAPE '\\'")
        values.append(_escaped(tag.strip().casefold()))
    if wanted.bbox is not None:
        west, south, east, north = wanted.bbox
        conditions.append("latitude_deg BETWEEN ? AND ?")
        across = "AND" if west <= east else "OR"  # over the date line
        conditions.append(f"(longitude_deg >= ? {across} longitude_deg <= ?)")
        values += [south, north, west, east]
    return " AND ".join(conditions), values

"""Where, when and under which license a picture was taken."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from enum import StrEnum
from typing import Any

import numpy as np

from panokit.errors import LicenseError, RecordError, UsageError
from panokit.frames import Rotation


class TimePrecision(StrEnum):
    """How much of a capture time is known. Street View gives a month and nothing finer."""

    SECOND = "second"
    DAY = "day"
    MONTH = "month"
    YEAR = "year"


@dataclass(frozen=True, slots=True, kw_only=True)
class License:
    """What may be done with a picture, and whom to credit.

    Attributes:
        id: SPDX identifier, or a name for terms that have none ("google-maps-platform").
        attribution: The line to show wherever the picture or its derivatives are shown.
        url: Where the terms stand.
        store: Whether the terms let a copy be kept.
        derive: Whether they let new works be made from it.
        train: Whether they let models be trained, tested or tuned with it.
        share_alike: Whether derived works must carry the same license.
    """

    id: str
    attribution: str
    url: str = ""
    store: bool = False
    derive: bool = False
    train: bool = False
    share_alike: bool = False

    def __post_init__(self) -> None:
        if not self.id:
            raise UsageError("A license needs an id; write 'unknown' where it is not known.")


def license_from_spdx(spdx: str, attribution: str, url: str = "") -> License:
    """The license that an SPDX identifier names; nothing is permitted by one not known here."""
    open_licenses = {
        "CC0-1.0": (False, "https://creativecommons.org/publicdomain/zero/1.0/"),
        "CC-BY-4.0": (False, "https://creativecommons.org/licenses/by/4.0/"),
        "CC-BY-SA-4.0": (True, "https://creativecommons.org/licenses/by-sa/4.0/"),
        "etalab-2.0": (False, "https://www.etalab.gouv.fr/licence-ouverte-open-licence/"),
        "ODbL-1.0": (True, "https://opendatacommons.org/licenses/odbl/1-0/"),
        "Apache-2.0": (False, "https://www.apache.org/licenses/LICENSE-2.0"),
        "MIT": (False, "https://opensource.org/license/mit"),
        "public domain": (False, "https://creativecommons.org/publicdomain/mark/1.0/"),
    }
    known = {name.lower(): name for name in open_licenses}
    name = known.get(spdx.lower())
    if name is None:
        return License(id=spdx or "unknown", attribution=attribution, url=url)
    share_alike, home = open_licenses[name]
    return License(
        id=name,
        attribution=attribution,
        url=url or home,
        store=True,
        derive=True,
        train=True,
        share_alike=share_alike,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Capture:
    """One picture as its provider describes it; metadata only, no pixels.

    Attributes:
        provider: "panoramax", "google-tiles", "folder", ...
        id: The provider's id; with `provider` it names the picture for good.
        license: Required: a picture without known terms has the license "unknown".
        latitude_deg: North positive, or None.
        longitude_deg: East positive, or None.
        elevation_m: Above sea level, or None.
        time: Timezone-aware, in UTC, or None; read it with `time_precision`.
        time_precision: How much of `time` is known; None where `time` is.
        heading_deg: Compass direction of the center column, clockwise from north, or None.
        pitch_deg: Of the camera, positive looking up, or None when it is not known.
        roll_deg: Of the camera, positive leaning to its right, or None when it is not known.
        width_px: Of the full picture at its native size, or None.
        height_px: Of the full picture at its native size, or None.
        place: The city or area it was fetched for, "" for none. Splits go by place.
        source_url: A page for people, without keys, "" for none.
        details: What else the provider said, as JSON values.
    """

    provider: str
    id: str
    license: License
    latitude_deg: float | None = None
    longitude_deg: float | None = None
    elevation_m: float | None = None
    time: datetime | None = None
    time_precision: TimePrecision | None = None
    heading_deg: float | None = None
    pitch_deg: float | None = None
    roll_deg: float | None = None
    width_px: int | None = None
    height_px: int | None = None
    place: str = ""
    source_url: str = ""
    details: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.provider or not self.id:
            raise UsageError("A capture needs a provider and an id.")
        if self.time is not None and self.time.tzinfo is None:
            raise UsageError(f"The time of capture {self.id!r} needs a timezone; use UTC.")
        if (self.time is None) != (self.time_precision is None):
            raise UsageError(f"Capture {self.id!r}: time and time_precision go together.")
        for name, low, high in (("latitude_deg", -90, 90), ("longitude_deg", -180, 180)):
            value = getattr(self, name)
            if value is not None and not low <= value <= high:
                raise UsageError(f"Capture {self.id!r}: {name} is {value}, not {low} to {high}.")

    @property
    def key(self) -> str:
        """A name for files: the id where it is a safe file name, else made safe, with provider."""
        return capture_key(self.provider, self.id)

    @property
    def world_from_camera(self) -> Rotation | None:
        """The pose, or None where the heading is not known; unknown pitch and roll are level."""
        if self.heading_deg is None:
            return None
        angles = (self.heading_deg, self.pitch_deg or 0.0, self.roll_deg or 0.0)
        return Rotation.from_heading_pitch_roll(*(float(np.deg2rad(a)) for a in angles))

    def at_place(self, place: str) -> "Capture":
        """The same capture, filed under a city or area."""
        return replace(self, place=place)

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`; None and empty fields are left out."""
        record: dict[str, Any] = asdict(self)
        if self.time is not None:
            record["time"] = self.time.astimezone(UTC).isoformat().replace("+00:00", "Z")
        record["time_precision"] = self.time_precision and str(self.time_precision)
        return {k: v for k, v in record.items() if v is not None and v != "" and v != {}}

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> "Capture":
        """The capture that `to_json` wrote.

        Raises:
            RecordError: If a required field is missing or a field is not known.
        """
        values = dict(record)
        try:
            values["license"] = License(**values["license"])
            if "time" in values:
                values["time"] = datetime.fromisoformat(values["time"])
                values["time_precision"] = TimePrecision(values["time_precision"])
            return cls(**values)
        except (KeyError, TypeError, ValueError) as error:
            raise RecordError(
                f"This is not a capture record ({error}). Fetch the picture again.",
                reason="bad-capture-record",
            ) from error


def capture_key(provider: str, id: str) -> str:
    """What a capture's files are called, with its provider and its id there."""
    safe = re.sub(r"[^A-Za-z0-9._-]+", "_", f"{provider}-{id}").strip("._")
    return safe[:120]


@dataclass(frozen=True, slots=True, kw_only=True)
class TileGrid:
    """How the tiles of a panorama lie in it.

    Attributes:
        width_px: Of the whole picture at this zoom; tiles may reach beyond it.
        height_px: Of the whole picture at this zoom.
        tile_width_px: Of a tile's cell.
        tile_height_px: Of a tile's cell.
        zoom: The provider's zoom level.
        missing: (column, row) of the tiles that could not be had.
    """

    width_px: int
    height_px: int
    tile_width_px: int
    tile_height_px: int
    zoom: int = 0
    missing: tuple[tuple[int, int], ...] = ()

    @property
    def columns(self) -> int:
        """Tiles in a row of tiles."""
        return -(-self.width_px // self.tile_width_px)

    @property
    def rows(self) -> int:
        """Tiles in a column of tiles."""
        return -(-self.height_px // self.tile_height_px)

    def cells(self) -> list[tuple[int, int]]:
        """(column, row) of every tile, row by row."""
        return [(x, y) for y in range(self.rows) for x in range(self.columns)]

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {**asdict(self), "missing": [list(cell) for cell in self.missing]}

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> "TileGrid":
        """The grid that `to_json` wrote."""
        missing = tuple((int(x), int(y)) for x, y in record.get("missing", ()))
        return cls(**{**record, "missing": missing})


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """One of several overlapping pictures of a capture, as a pinhole camera saw it.

    Its pose is that of the camera in the world: level with north at heading 0. The center of
    projection is the center of the picture, and pixels are square.

    Attributes:
        name: Of its file in the capture's folder.
        heading_deg: Compass direction of its center.
        pitch_deg: Of its center, positive looking up.
        fov_deg: Angle between the left and the right edge.
        width_px: Of the picture.
        height_px: Of the picture.
        roll_deg: Of the camera, positive leaning to its right.
        masked_px: (left, top, right, bottom) of the rectangles that do not show the scene,
            such as a logo; right and bottom are excluded.
    """

    name: str
    heading_deg: float
    pitch_deg: float
    fov_deg: float
    width_px: int
    height_px: int
    roll_deg: float = 0.0
    masked_px: tuple[tuple[int, int, int, int], ...] = ()

    @property
    def world_from_view(self) -> Rotation:
        """The pose: a direction in the view's camera frame becomes one in the world."""
        angles = (self.heading_deg, self.pitch_deg, self.roll_deg)
        return Rotation.from_heading_pitch_roll(*(float(np.deg2rad(a)) for a in angles))

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {**asdict(self), "masked_px": [list(box) for box in self.masked_px]}

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> "View":
        """The view that `to_json` wrote."""
        boxes = tuple(tuple(int(edge) for edge in box) for box in record.get("masked_px", ()))
        return cls(**{**record, "masked_px": boxes})


def require_right_to_train(captures: Iterable[Capture], own_right: str = "") -> None:
    """Check that models may be trained, tested or tuned with what was made of these pictures.

    Args:
        captures: Where the material is from.
        own_right: What else gives the user the right, in words ("agreement with Google of
            2026-01-05"); then the terms of the sources are not what counts.

    Raises:
        LicenseError: If the license of one does not permit it; the message names it.
    """
    denied = {one.key: one.license for one in captures if not one.license.train}
    if not denied or own_right.strip():
        return
    key, terms = next(iter(denied.items()))
    more = f" and {len(denied) - 1} more" if len(denied) > 1 else ""
    raise LicenseError(
        f"{key}{more}: the license {terms.id!r} does not permit training. Leave out what is from "
        'there; or, if you have a right of your own, say which: --own-right "..."'
    )


def local_capture(name: str, **known: Any) -> Capture:
    """A capture for a picture from the user's own disk, of which only the name is known."""
    terms = License(
        id="unknown", attribution="", store=True, derive=True, train=False, share_alike=False
    )
    return Capture(provider="folder", id=name, **{"license": terms, **known})


def wrap_degrees(angle_deg: float) -> float:
    """The same angle in (-180, 180]; services send roll in [0, 360)."""
    wrapped = -((-angle_deg + 180.0) % 360.0 - 180.0)
    return 180.0 if wrapped == -180.0 else wrapped

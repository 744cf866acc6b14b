"""The settings of `fetch`."""

from datetime import date
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from pydantic import Field, field_validator, model_validator

from panokit.settings import Settings

VERSION = "1"


class PlaceSettings(Settings):
    """A place that is not in the table of cities: a disc around a point."""

    name: str = Field(min_length=1)
    """What to file its pictures under."""

    latitude_deg: float = Field(ge=-90, le=90)
    """North positive."""

    longitude_deg: float = Field(ge=-180, le=180)
    """East positive."""

    radius_m: float = Field(default=1000.0, gt=0, le=100_000)
    """How far from the point pictures may lie."""


class FetchSettings(Settings):
    """Which street panoramas to fetch, from where, and how much may be spent on it."""

    source: Literal["panoramax", "mapillary", "google-tiles", "google-static", "folder"] = (
        "panoramax"
    )
    """Where from. Panoramax is open and needs no key; read the licenses of the others."""

    cities: Annotated[tuple[str, ...], Parameter(alias="--city")] = ()
    """Cities by name, with a country code where the name is not unique: "Bristol, GB"."""

    city_list: Path | None = None
    """A text file with one city on a line; what follows a # is a comment."""

    # A command line has no way to write them; --point and --bbox are its own.
    places: Annotated[tuple[PlaceSettings, ...], Parameter(parse=False, show=False)] = ()
    """Places of your own, each a name, a point and a radius."""

    area_file: Path | None = None
    """A GeoJSON file of polygons, or a CSV table of points: latitude, longitude, maybe radius."""

    bbox: tuple[float, float, float, float] | None = None
    """A box instead of a city: west, south, east, north in degrees."""

    point: tuple[float, float] | None = None
    """A point instead of a city: latitude, longitude in degrees."""

    radius_m: float | None = Field(default=None, gt=0, le=100_000)
    """How far from the point (else 1000) or a city's center (else the city's own) to look."""

    pictures: Annotated[tuple[str, ...], Parameter(alias="--picture")] = ()
    """Pictures by id, or by the address of their page in the browser; all of them are taken."""

    picture_list: Path | None = None
    """A text file with one id or address on a line."""

    folder: Path | None = None
    """For the source "folder": where the pictures are. All of them are taken."""

    license: str = ""
    """For the source "folder": the pictures' license, as SPDX id ("CC-BY-4.0")."""

    attribution: str = ""
    """For the source "folder": whom to credit."""

    count: int = Field(default=10, ge=1)
    """How many panoramas to have of each place."""

    min_distance_m: float = Field(default=25.0, ge=0)
    """How far apart the panoramas of a place are at least."""

    snap_m: float | None = Field(default=None, gt=0, le=1000)
    """How far from a point pictures may lie (else 50, and 200 where Google has none so near)."""

    cell_m: float | None = Field(default=None, gt=0)
    """Take at most one panorama of each square cell of this side."""

    per_sequence: int | None = Field(default=None, ge=1)
    """Take at most so many panoramas of one drive."""

    per_month: int | None = Field(default=None, ge=1)
    """Take at most so many panoramas of a place that are of the same month."""

    indoor: Annotated[bool, Parameter(negative=())] = False
    """Take indoor panoramas too."""

    date_from: date | None = None
    """Only pictures taken on this day or later."""

    date_to: date | None = None
    """Only pictures taken on this day or earlier."""

    width_px: int = Field(default=4096, ge=256)
    """The least width wanted; tile services send the first zoom that has it."""

    zoom: int | None = Field(default=None, ge=0, le=5)
    """A tile service's zoom, instead of a least width. Small panoramas have fewer zooms."""

    view_fov_deg: float = Field(default=75.0, ge=50, le=100)
    """For google-static: the width of a view. Narrower ones are finer, and more of them."""

    allow_missing: Annotated[bool, Parameter(negative=())] = False
    """Take panoramas of which some tiles cannot be had; what is missing is recorded."""

    seed: int = 0
    """Another seed looks at other points of the same place."""

    endpoint: str = ""
    """Another server of the same kind: your Panoramax instance, or a local look-alike."""

    accept_terms: tuple[Literal["google"], ...] = ()
    """Sources whose terms you have read and accept: "google"."""

    max_requests: int | None = Field(default=None, ge=0)
    """Stop before sending more requests than this."""

    max_cost_usd: Annotated[float | None, Parameter(alias="--max-cost")] = Field(default=None, ge=0)
    """Stop before spending more than this by list price; free amounts are not deducted."""

    prices: Path | None = None
    """A TOML table of prices and quotas, instead of the one that panokit brings."""

    requests_per_s: float = Field(default=20.0, gt=0)
    """How fast to ask one host."""

    concurrency: int = Field(default=8, ge=1, le=32)
    """How many requests may be under way at once."""

    dry_run: Annotated[bool, Parameter(negative=())] = False
    """Only find out what there is, and report what fetching it would take."""

    @field_validator("endpoint")
    @classmethod
    def _web_address(cls, endpoint: str) -> str:
        if endpoint and not endpoint.startswith(("https://", "http://")):
            raise ValueError(f"{endpoint!r} is not a web address; write https://...")
        return endpoint.rstrip("/")

    @field_validator("bbox")
    @classmethod
    def _box_in_order(
        cls, bbox: tuple[float, float, float, float] | None
    ) -> tuple[float, float, float, float] | None:
        if bbox is not None:
            west, south, east, north = bbox
            if not (-180 <= west < east <= 180 and -90 <= south < north <= 90):
                raise ValueError("a box is west, south, east, north in degrees, west < east")
        return bbox

    @model_validator(mode="after")
    def _consistent(self) -> "FetchSettings":
        if self.date_from and self.date_to and self.date_from > self.date_to:
            raise ValueError(f"date_from {self.date_from} is after date_to {self.date_to}")
        if self.folder is not None and self.source != "folder":
            raise ValueError('folder needs source = "folder"')
        if (self.pictures or self.picture_list) and self.source == "folder":
            raise ValueError("a folder has no pictures by id")
        return self

"""The settings of `fetch`."""

from datetime import date
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Group, Parameter
from pydantic import Field, field_validator, model_validator

from panokit.settings import Settings

VERSION = "1"

# The panels of --help, in this order.
_WHERE = Group("Where to look", sort_key=1)
_SOURCE = Group("Source", sort_key=2)
_WHICH = Group("Which panoramas", sort_key=3)
_SIZE = Group("How large", sort_key=4)
_BUDGET = Group("Budget and pace", sort_key=5)


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


class PullSettings(Settings):
    """Which HDR maps of Poly Haven to put into a library."""

    # On the command line they stand by themselves.
    names: Annotated[tuple[str, ...], Parameter(parse=False, show=False)] = ()
    """Maps by name, as in their addresses: "kloofendal_48d_partly_cloudy"."""

    category: tuple[str, ...] = ()
    """Only maps that are in all of these categories: "urban", "outdoor"."""

    query: str = ""
    """Only maps whose name, tags or categories hold each of these words."""

    published_before: date | None = None
    """Only maps that were published before this day, such as those of a paper's time."""

    order: Literal["downloads", "published"] = "downloads"
    """Which come first: the most downloaded, or the first published."""

    count: int | None = Field(default=None, ge=1)
    """At most so many; else all that match."""

    resolution: Literal["1k", "2k", "4k", "8k", "16k"] = "2k"
    """Width in 1024 px; the next smaller one where a map is not that large."""

    format: Literal["exr", "hdr"] = "exr"
    """OpenEXR, or Radiance."""

    endpoint: str = ""
    """Another server of the same kind, such as a local look-alike."""

    max_requests: int | None = Field(default=None, ge=0)
    """Stop before sending more requests than this."""

    requests_per_s: float = Field(default=5.0, gt=0)
    """How fast to ask one host."""

    dry_run: Annotated[bool, Parameter(negative=())] = False
    """Only list what would be pulled, and its size."""


class FetchSettings(Settings):
    """Which street panoramas to fetch, from where, and how much may be spent on it."""

    source: Annotated[
        Literal["panoramax", "mapillary", "google-tiles", "google-static", "folder"],
        Parameter(group=_SOURCE),
    ] = "panoramax"
    """Where from. Panoramax is open and needs no key; read the licenses of the others."""

    cities: Annotated[tuple[str, ...], Parameter(group=_WHERE, alias="--city")] = ()
    """Cities by name, with a country code where the name is not unique: "Bristol, GB"."""

    city_list: Annotated[Path | None, Parameter(group=_WHERE)] = None
    """A text file with one city on a line; what follows a # is a comment."""

    # A command line has no way to write them; --point and --bbox are its own.
    places: Annotated[tuple[PlaceSettings, ...], Parameter(parse=False, show=False)] = ()
    """Places of your own, each a name, a point and a radius."""

    area_file: Annotated[Path | None, Parameter(group=_WHERE)] = None
    """A GeoJSON file of polygons, or a CSV table of points: latitude, longitude, maybe radius."""

    bbox: Annotated[tuple[float, float, float, float] | None, Parameter(group=_WHERE)] = None
    """A box instead of a city: west, south, east, north in degrees."""

    point: Annotated[tuple[float, float] | None, Parameter(group=_WHERE)] = None
    """A point instead of a city: latitude, longitude in degrees."""

    radius_m: Annotated[float | None, Parameter(group=_WHERE)] = Field(
        default=None, gt=0, le=100_000
    )
    """How far from the point (else 1000) or a city's center (else the city's own) to look."""

    pictures: Annotated[tuple[str, ...], Parameter(group=_WHERE, alias="--picture")] = ()
    """Pictures by id, or by the address of their page in the browser; all of them are taken."""

    picture_list: Annotated[Path | None, Parameter(group=_WHERE)] = None
    """A text file with one id or address on a line; what follows a space and a # is a comment."""

    folder: Annotated[Path | None, Parameter(group=_SOURCE)] = None
    """For the source "folder": where the pictures are. All of them are taken."""

    license: Annotated[str, Parameter(group=_SOURCE)] = ""
    """For the source "folder": the pictures' license, as SPDX id ("CC-BY-4.0")."""

    attribution: Annotated[str, Parameter(group=_SOURCE)] = ""
    """For the source "folder": whom to credit."""

    count: Annotated[int, Parameter(group=_WHICH)] = Field(default=10, ge=1)
    """How many panoramas to have of each place."""

    min_distance_m: Annotated[float, Parameter(group=_WHICH)] = Field(default=25.0, ge=0)
    """How far apart the panoramas of a place are at least."""

    snap_m: Annotated[float | None, Parameter(group=_WHICH)] = Field(default=None, gt=0, le=1000)
    """How far from a point pictures may lie (else 50, and 200 where Google has none so near)."""

    cell_m: Annotated[float | None, Parameter(group=_WHICH)] = Field(default=None, gt=0)
    """Take at most one panorama of each square cell of this side."""

    per_sequence: Annotated[int | None, Parameter(group=_WHICH)] = Field(default=None, ge=1)
    """Take at most so many panoramas of one drive."""

    per_month: Annotated[int | None, Parameter(group=_WHICH)] = Field(default=None, ge=1)
    """Take at most so many panoramas of a place that are of the same month."""

    indoor: Annotated[bool, Parameter(group=_WHICH, negative=())] = False
    """Take indoor panoramas too."""

    date_from: Annotated[date | None, Parameter(group=_WHICH)] = None
    """Only pictures taken on this day or later."""

    date_to: Annotated[date | None, Parameter(group=_WHICH)] = None
    """Only pictures taken on this day or earlier."""

    licenses: Annotated[tuple[str, ...], Parameter(group=_WHICH)] = ()
    """Only pictures under one of these licenses, as SPDX ids ("CC-BY-4.0"); any if not given."""

    width_px: Annotated[int, Parameter(group=_SIZE)] = Field(default=4096, ge=256)
    """The least width wanted; tile services send the first zoom that has it."""

    zoom: Annotated[int | None, Parameter(group=_SIZE)] = Field(default=None, ge=0, le=5)
    """A tile service's zoom, instead of a least width. Small panoramas have fewer zooms."""

    view_fov_deg: Annotated[float, Parameter(group=_SIZE)] = Field(default=75.0, ge=50, le=100)
    """For google-static: the width of a view. Narrower ones are finer, and more of them."""

    allow_missing: Annotated[bool, Parameter(group=_SIZE, negative=())] = False
    """Take panoramas of which some tiles cannot be had; what is missing is recorded."""

    seed: Annotated[int, Parameter(group=_WHICH)] = 0
    """Another seed looks at other points of the same place."""

    endpoint: Annotated[str, Parameter(group=_SOURCE)] = ""
    """Another server of the same kind: your Panoramax instance, or a local look-alike."""

    accept_terms: Annotated[tuple[Literal["google"], ...], Parameter(group=_SOURCE)] = ()
    """Sources whose terms you have read and accept: "google"."""

    max_requests: Annotated[int | None, Parameter(group=_BUDGET)] = Field(default=None, ge=0)
    """Stop before sending more requests than this."""

    max_cost_usd: Annotated[float | None, Parameter(group=_BUDGET, alias="--max-cost")] = Field(
        default=None, ge=0
    )
    """Stop before spending more than this by list price; free amounts are not deducted."""

    prices: Annotated[Path | None, Parameter(group=_BUDGET)] = None
    """A TOML table of prices and quotas, instead of the one that panokit brings."""

    requests_per_s: Annotated[float, Parameter(group=_BUDGET)] = Field(default=20.0, gt=0)
    """How fast to ask one host."""

    concurrency: Annotated[int, Parameter(group=_BUDGET)] = Field(default=8, ge=1, le=32)
    """How many requests may be under way at once."""

    dry_run: Annotated[bool, Parameter(group=_BUDGET, negative=())] = False
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

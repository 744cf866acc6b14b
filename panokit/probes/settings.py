"""The settings of the probe library: what to add, list, select and export."""

from datetime import date
from typing import Annotated, Literal

from cyclopts import Group, Parameter
from pydantic import Field, field_validator, model_validator

from panokit.settings import Settings

VERSION = "2"

Kind = Literal["native", "lifted", "synthetic"]
Target = Literal["exr", "hdr", "blender", "usd", "mitsuba", "gltf", "harmonics", "parquet"]

Balance = Literal["category", "place", "kind", "none"]

_FILTERS = Group("Which probes", sort_key=1)
_SELECTION = Group("How to select", sort_key=2)
_NO_FLAG = Parameter(negative=())


class ProbeFilter(Settings):
    """Which probes; a field that is not set lets all pass."""

    name: Annotated[str | None, Parameter(group=_FILTERS)] = None
    """A part of the name, in any case."""

    category: Annotated[str | None, Parameter(group=_FILTERS)] = None
    """The kind of scene, or its beginning: "outdoor" takes "outdoor_night" too."""

    kind: Annotated[Kind | None, Parameter(group=_FILTERS)] = None
    """"native" was captured in HDR, "lifted" made of a photograph, "synthetic" rendered."""

    place: Annotated[str | None, Parameter(group=_FILTERS)] = None
    """The city or area, in any case."""

    bbox: Annotated[tuple[float, float, float, float] | None, Parameter(group=_FILTERS)] = None
    """Within this box: west, south, east, north in degrees; west may be the larger."""

    date_from: Annotated[date | None, Parameter(group=_FILTERS)] = None
    """Taken on this day (UTC) or later."""

    date_to: Annotated[date | None, Parameter(group=_FILTERS)] = None
    """Taken on this day (UTC) or earlier."""

    provider: Annotated[str | None, Parameter(group=_FILTERS)] = None
    """Where the picture is from: "panoramax", "polyhaven", "folder", ..."""

    license: Annotated[str | None, Parameter(group=_FILTERS)] = None
    """The license's id, in any case: "CC0-1.0"."""

    trainable: Annotated[bool | None, Parameter(group=_FILTERS)] = None
    """The license lets models be trained, or (--no-trainable) does not."""

    derivable: Annotated[bool | None, Parameter(group=_FILTERS)] = None
    """The license lets new works be made of it, or does not."""

    storable: Annotated[bool | None, Parameter(group=_FILTERS)] = None
    """The license lets a copy be kept, or does not."""

    verdict: Annotated[Literal["pass", "fail"] | None, Parameter(group=_FILTERS)] = None
    """What QA said."""

    plausibility_max: Annotated[float | None, Parameter(group=_FILTERS)] = None
    """At most so far from what captured maps look like, as QA measured it; 1 is typical."""

    dynamic_range_min_stops: Annotated[float | None, Parameter(group=_FILTERS)] = None
    """The least dynamic range, from the median to the peak."""

    has_sun: Annotated[bool | None, Parameter(group=_FILTERS)] = None
    """The sun is in it, or (--no-has-sun) is not."""

    tags: Annotated[tuple[str, ...], Parameter(group=_FILTERS, alias="--tag")] = ()
    """Has all of these tags."""

    @field_validator("bbox")
    @classmethod
    def _on_the_globe(
        cls, bbox: tuple[float, float, float, float] | None
    ) -> tuple[float, float, float, float] | None:
        if bbox is not None:
            west, south, east, north = bbox
            if not (-180 <= west <= 180 and -180 <= east <= 180 and -90 <= south <= north <= 90):
                raise ValueError("a box is west, south, east, north in degrees, south <= north")
        return bbox

    @model_validator(mode="after")
    def _in_order(self) -> "ProbeFilter":
        if self.date_from and self.date_to and self.date_from > self.date_to:
            raise ValueError(f"date_from {self.date_from} is after date_to {self.date_to}")
        return self


class AddSettings(Settings):
    """How maps are put into a library."""

    in_place: Annotated[bool, _NO_FLAG] = False
    """Leave the files where they are; the library keeps their digests and a preview."""

    repair: Annotated[bool, _NO_FLAG] = False
    """Clean values that are not physical instead of rejecting the map."""

    category: str = ""
    """The kind of scene; else what the map's record or the folder's manifest.csv says."""

    tags: Annotated[tuple[str, ...], Parameter(alias="--tag")] = ()
    """Words to find them by, besides those of their records."""

    place: str = ""
    """Where they were taken, for maps without a record."""

    license: str = ""
    """For maps without a record: their license, as SPDX id ("CC0-1.0")."""

    attribution: str = ""
    """For maps without a record: whom to credit."""

    kind: Kind | None = None
    """For maps without a record: "native", "lifted" or "synthetic"."""

    @model_validator(mode="after")
    def _repaired_copies_only(self) -> "AddSettings":
        if self.in_place and self.repair:
            raise ValueError("a map that is used in place cannot be repaired; add a copy")
        return self


class SelectSettings(Settings):
    """How to choose some of a library's probes: evenly, and as different as can be."""

    count: Annotated[int, Parameter(group=_SELECTION)] = Field(ge=1)
    """How many to select; fewer if there are not as many."""

    balance: Annotated[Balance, Parameter(group=_SELECTION)] = "category"
    """As many of each, as far as there are; "none" looks at differences only."""

    per_place: Annotated[int | None, Parameter(group=_SELECTION)] = Field(default=None, ge=1)
    """At most so many of one place."""

    seed: Annotated[int, Parameter(group=_SELECTION)] = 0
    """Another seed begins with another probe."""


class ExportSettings(Settings):
    """What to make of probes for other tools."""

    to: Target
    """The tool or format; "parquet" is the table of all that the index knows."""

    sun: Literal["in-map", "apart"] = "in-map"
    """Where the sun is: in the map, or taken out of it and given as a light of its own."""

    width_px: int | None = Field(default=None, ge=16, multiple_of=2)
    """Reduce maps to this width, with their energy kept; else they keep theirs."""

    half: Annotated[bool, Parameter(negative=())] = False
    """Half floats in EXR files, scaled where needed so that nothing overflows."""

    harmonics_order: int = Field(default=8, ge=0, le=64)
    """For harmonics: the highest degree."""

    face_px: int = Field(default=256, ge=32, le=1024)
    """For glTF: the width of a face of the sharpest cube map, a power of two."""

    @field_validator("face_px")
    @classmethod
    def _power_of_two(cls, face_px: int) -> int:
        if face_px & (face_px - 1):
            raise ValueError("the width of a face is a power of two: 128, 256, 512")
        return face_px

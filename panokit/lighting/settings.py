"""Settings of `panokit.lighting`; imports nothing heavy."""

from typing import Literal

from pydantic import Field

from panokit.settings import Settings

# Changes when the same views give another estimate or other files.
VERSION = "1"

Export = Literal["blender", "usd", "mitsuba", "gltf"]


class EstimateSettings(Settings):
    """What is asked of each estimate."""

    confidence: bool = True
    """Whether the mirrored views are read too, to tell how sure the estimate is; it takes twice
    as long."""


class OutputSettings(Settings):
    """What is written of an estimate."""

    frame: Literal["level", "camera"] = "level"
    """Which way up the lat-long map and all that is made of it are: "level" takes the camera's
    tilt out where it is known, "camera" leaves it in. The 64x64 map is always the camera's."""

    width_px: int = Field(default=256, ge=64, le=4096, multiple_of=4)
    """Width of the lat-long map; nothing finer than 64x64 is in it."""

    gaussians: int = Field(default=12, ge=1, le=128)
    """How many spherical Gaussians stand for the map."""

    harmonics_orders: tuple[int, ...] = (2, 4)
    """Orders of spherical harmonics, a file each: 2 has 9 coefficients, 4 has 25."""

    exports: tuple[Export, ...] = ("blender", "usd", "mitsuba", "gltf")
    """Other tools to write files for."""

    sun: Literal["in-map", "apart"] = "in-map"
    """Where the primary light goes in those files: it stays in the map, or becomes a light of
    its own with sharp shadows. Without a dominant light it stays."""

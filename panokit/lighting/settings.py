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


class SelectSettings(Settings):
    """How a click becomes an object."""

    tolerance: float = Field(default=0.0, ge=0, le=100)
    """How far from the clicked color (CIE LAB) the object's colors may be, brightness counting
    little; 0 chooses what suits: the most that does not run out into the background."""

    grow: bool = True
    """Whether what was filled is then grown by the colors in it against those around it; not where
    a tolerance is set."""

    close_px: int = Field(default=5, ge=0, le=31)
    """Gaps up to about this size are closed, in pixels of a frame 640 wide."""


class TrackSettings(Settings):
    """How the object is followed."""

    tracker: Literal["kcf", "csrt"] = "kcf"
    """KCF is the faster; CSRT takes three times as long and follows changes of size by itself."""

    width_px: int = Field(default=640, ge=160, le=1920)
    """Frames are followed at this width, whatever they have."""

    likeness: float = Field(default=0.4, ge=0, le=1)
    """The box counts as lost where its colors are less like those of the object than this."""


class SnapshotSettings(Settings):
    """How two frames become two views."""

    shift: float = Field(default=0.2, gt=0.02, le=1)
    """How far the object has to move sideways before the second snapshot, in parts of its larger
    side. Networks were trained with cameras a fifth of the object's size apart."""

    fill: float = Field(default=0.65, ge=0.3, le=0.9)
    """How much of the views the object fills, as in training."""

    size_px: int = Field(default=128, ge=64, le=1024)
    """Of the views."""

    fov_deg: float = Field(default=60.0, gt=5, lt=150)
    """What the video shows from its left to its right edge; phones hold about 60 degrees."""

    pitch_deg: float = Field(default=0.0, gt=-90, lt=90)
    """How far the camera looked up; for a level map."""

    roll_deg: float = Field(default=0.0, ge=-90, le=90)
    """How far the camera leaned to its right; for a level map."""

    blur: float = Field(default=0.0375, ge=0, le=0.2)
    """How blurred the background is made, in parts of the view's width: as in training, where
    1.5 of 40 degrees were one pixel."""


class RunningSettings(Settings):
    """How an estimate is kept up over a video."""

    change: float = Field(default=0.2, gt=0, le=4)
    """When the brightness of what is seen changed by this part, the light is read anew and the
    old readings are forgotten."""

    most: int = Field(default=8, ge=1, le=64)
    """How many readings of the same light are averaged, the latest ones."""


class SessionSettings(Settings):
    """From a click in a video to the light of its scene."""

    model: str = "lighting-1"
    """What reads the light: the id of a released model, or a folder with a model.toml."""

    select: SelectSettings = SelectSettings()
    track: TrackSettings = TrackSettings()
    snapshot: SnapshotSettings = SnapshotSettings()
    estimate: EstimateSettings = EstimateSettings()
    running: RunningSettings = RunningSettings()

"""What a stereo dataset is made of; one definition for Python, the command line and TOML."""

from typing import Literal

from pydantic import Field

from panokit.settings import Settings

VERSION = "1"
Range = tuple[float, float]


class ObjectSettings(Settings):
    """The objects."""

    kinds: tuple[str, ...] = ()
    """Kinds of procedural objects; all of them if not given."""

    per_kind: int = Field(default=250, ge=1)
    """How many different objects of each kind there are; each is made from its number."""

    meshes: str = ""
    """A folder of PLY, OBJ or glTF files to use as objects too."""

    mesh_share: float = Field(default=0.5, ge=0, le=1)
    """How many of the samples show one of those, where there are any."""

    materials: int = Field(default=1, ge=1, le=3)
    """Most materials that an object has."""

    textured_share: float = Field(default=0.0, ge=0, le=1)
    """How many of the materials have a texture instead of one color."""


class RigSettings(Settings):
    """The pair of cameras."""

    width_px: int = Field(default=256, ge=16)
    """Width and height of each picture."""

    fov_deg: float = Field(default=40.0, gt=1, lt=150)
    """From the left to the right edge."""

    baseline_m: Range = (0.2, 0.2)
    """Lowest and highest distance between the cameras; objects are about a meter in size."""

    toe_in: bool = False
    """Whether the cameras are turned toward the object, instead of being parallel."""

    translate: bool = False
    """Whether the pictures of parallel cameras are shifted so that the object has no disparity
    (horizontal image translation)."""

    fill: Range = (0.5, 0.8)
    """Lowest and highest share of the picture's width or height that the object spans."""

    pitch_deg: Range = (-30.0, 10.0)
    """Lowest and highest angle at which the cameras look up."""

    roll_deg: float = Field(default=0.0, ge=0, le=45)
    """How far the cameras may lean to either side."""


class LightSettings(Settings):
    """The light."""

    tilt_deg: float = Field(default=0.0, ge=0, le=90)
    """By how much a map may be tilted at random, besides being turned."""

    exposure_stops: float = Field(default=0.5, ge=0)
    """Standard deviation of the exposure around what a camera's metering would choose."""

    selection: str = ""
    """A file of `panokit probes select`: only these probes of the libraries."""

    own_right: str = ""
    """What gives the right to train with maps whose license does not, in words."""


class DatasetSettings(Settings):
    """A stereo dataset: everything that decides its samples."""

    seed: int = Field(default=0, ge=0)
    """Sample i is made from this number and i alone."""

    objects: ObjectSettings = ObjectSettings()
    rig: RigSettings = RigSettings()
    light: LightSettings = LightSettings()

    floor_share: float = Field(default=0.0, ge=0, le=1)
    """How many of the objects stand on a floor that catches their shadow, instead of floating."""

    renderer: Literal["mitsuba", "blender", "analytic"] = "mitsuba"
    """What renders: Mitsuba 3, Cycles in a Blender of its own, or a tiny formula for tests."""

    samples: int = Field(default=64, ge=1)
    """Paths per pixel."""

    bounces: int = Field(default=4, ge=0)
    """How often light may be reflected on its way."""

    denoise: bool = False
    """Whether noise is filtered out."""

    background_blur_deg: float = Field(default=1.5, ge=0)
    """How blurred the background is, as behind a lens that is focused on the object."""

    hdr: bool = False
    """Whether the linear radiance of both views and the albedo are written too."""

    validation_share: float = Field(default=0.1, ge=0, lt=1)
    """How many of the samples are of places and objects set apart for validation."""

    test_share: float = Field(default=0.1, ge=0, lt=1)
    """The same for the final test."""

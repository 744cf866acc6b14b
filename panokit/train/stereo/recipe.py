"""Recipes of networks that read light: everything that decides a model, in TOML."""

from pathlib import Path
from typing import Literal, TypeVar

from pydantic import Field, ValidationError

from panokit.color.hdr_coding import ColorCode, HdrCoding
from panokit.errors import SettingsError
from panokit.networks.stereo.settings import StereoNetSettings
from panokit.settings import Settings
from panokit.train.recipe import Precision, read_table

Kept = TypeVar("Kept", bound=Settings)
Kind = Literal["stereo", "dematerial", "dense-reflectance", "picture-reflectance"]


class CodingRecipe(Settings):
    """How radiance becomes numbers."""

    brightest: float = Field(default=1e3, gt=0)
    """The radiance that is coded as 1; white of the pictures is 1."""

    color: ColorCode = ColorCode.LAB
    """What becomes of the logs of red, green and blue."""

    @property
    def coding(self) -> HdrCoding:
        """The coding itself."""
        return HdrCoding(brightest=self.brightest, color=self.color)


class LossRecipe(Settings):
    """How much each error counts."""

    l1: float = Field(default=1.0, ge=0)
    """Mean absolute difference of code values: the thesis's loss."""

    dssim: float = Field(default=0.0, ge=0)
    """Structural dissimilarity of radiance, with the thesis's windows."""

    render: float = Field(default=0.0, ge=0)
    """Relative difference of what scenes look like in the light: a matte ball, a satin ball and
    a plane with its shadows."""

    energy: float = Field(default=0.0, ge=0)
    """Log ratio of energy."""

    direction: float = Field(default=0.0, ge=0)
    """Difference of light vectors, over the energy."""


class NormalsRecipe(Settings):
    """Which normals a network on reflectance maps is given."""

    noise_deg: float = Field(default=0.0, ge=0, le=45)
    """Mean error that is added to the true normals."""

    smooth_px: float = Field(default=0.0, ge=0)
    """How far neighbors have the same error."""


class ScheduleRecipe(Settings):
    """How long and how fast."""

    epochs: int = Field(default=30, ge=1)
    """Times that each sample is seen."""

    tail_epochs: int = Field(default=0, ge=0)
    """At most so many more, at a twentieth of the learning rate, until training has converged."""

    batch: int = Field(default=24, ge=1)
    """Samples per step; 24 in the thesis."""

    learning_rate: float = Field(default=3e-4, gt=0)
    """At the start; it falls to zero on a cosine over `epochs`."""

    weight_decay: float = Field(default=1e-4, ge=0)
    """Of AdamW."""

    ema_decay: float = Field(default=0.99, ge=0, lt=1)
    """Of the average over steps that is validated and released."""

    precision: Precision = "fp32"
    """Arithmetic of the network: "bf16" halves the time on processors that have it."""

    swap_views: bool = False
    """Whether pairs are mirrored at random: left and right change places and sides."""


class SourceRecipe(Settings):
    """A part of the training samples."""

    data: str = "."
    """The dataset's folder, seen from that of `--data`."""

    places: tuple[str, ...] = ()
    """Only samples whose light is from these places; all if empty."""

    samples: int = Field(default=0, ge=0)
    """Only so many, the first ones; all if 0."""


class LightingRecipe(Settings):
    """A model that reads light, from data to release."""

    id: str
    """Of the model; its folder has this name."""

    task: Literal["lighting"] = "lighting"
    """What the model is for."""

    kind: Kind = "stereo"
    """From two views; from sparse reflectance maps and the background; from a sparse reflectance
    map to a dense one; or from a picture to a dense reflectance map."""

    network: StereoNetSettings = StereoNetSettings()
    """The network; kinds other than "stereo" take its sizes, width and layers."""

    materials: int = Field(default=1, ge=1, le=3)
    """Of "dematerial": reflectance maps that go in."""

    normals: NormalsRecipe = NormalsRecipe()
    """Of the kinds that take reflectance maps."""

    coding: CodingRecipe = CodingRecipe()
    """How radiance is coded."""

    loss: LossRecipe = LossRecipe()
    """What is made small."""

    schedule: ScheduleRecipe = ScheduleRecipe()
    """How long and how fast."""

    samples: int = Field(default=0, ge=0)
    """How many training samples are used; all if 0."""

    sources: tuple[SourceRecipe, ...] = ()
    """Where training samples are from, if not all from `--data`; `samples` then does not count."""

    seed: int = Field(default=0, ge=0)
    """Of weights and batches."""


def read_lighting_recipe(path: Path) -> LightingRecipe:
    """The recipe in a TOML file.

    Raises:
        StorageError: If the file cannot be read.
        SettingsError: If it is not TOML, or holds a key or value that a recipe has not.
    """
    return validated(LightingRecipe, read_table(path), path)


def validated(kind: type[Kept], table: dict[str, object], path: Path) -> Kept:
    """The settings in a table of a file.

    Raises:
        SettingsError: If a key or value does not belong there; it names the first of them.
    """
    try:
        return kind.model_validate(table)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise SettingsError(f"{path}: {place}: {first['msg']}.") from error

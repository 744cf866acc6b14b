"""Training recipes: everything that decides what a released expansion model is.

A recipe's digest leaves out what is at its default, so that a key added later changes no
digest of the recipes before it. For the same reason defaults never change.
"""

import tomllib
from pathlib import Path
from typing import Literal, TypeVar

from pydantic import Field, ValidationError, field_validator

from panokit.errors import SettingsError, StorageError
from panokit.provenance import digest_of
from panokit.settings import Settings

Precision = Literal["auto", "fp32", "bf16"]
Architecture = Literal["panokit", "expandnet"]
# Of the city that `panokit.synthetic.embedded` holds.
EMBEDDED_SEED = 7
_R = TypeVar("_R", bound=Settings)


class SyntheticRecipe(Settings):
    """Light that nobody had to capture: rendered streets and computed skies, without limit."""

    places: int = Field(default=0, ge=0)
    """Streets and squares of the synthetic city, rendered with Mitsuba."""

    skies: int = Field(default=0, ge=0)
    """Analytic clear and cloudy skies with their sun, over plain ground."""

    grounded: int = Field(default=0, ge=0)
    """Such skies over the ground of an outdoor probe, which then belongs to that probe's fold."""

    width_px: int = Field(default=512, ge=64, le=4096, multiple_of=4)
    """Of the rendered maps."""

    samples: int = Field(default=32, ge=1, le=4096)
    """Light paths through each pixel of a rendered map."""

    shots_per_map: int = Field(default=4, ge=1)
    """Pictures taken of each map."""

    share: float = Field(default=0.2, gt=0, lt=1)
    """How often a training picture is one of these and not of a probe."""

    seed: int = Field(default=11, ge=0)
    """Another seed gives another city and other skies. Seed 7 is refused: the city that travels
    with panokit has it, and is there to judge by."""

    @field_validator("seed")
    @classmethod
    def _not_the_judge_s(cls, seed: int) -> int:
        if seed == EMBEDDED_SEED:
            raise ValueError(f"seed {seed} is the city that methods are judged by; take another")
        return seed

    @property
    def digest(self) -> str:
        """See the module."""
        return digest_of(self.model_dump(mode="json", exclude_defaults=True))


class DataRecipe(Settings):
    """The pictures to train on."""

    shots_per_probe: int = Field(default=16, ge=1)
    """Pictures taken of each probe with random exposures and curves."""

    wide_per_probe: int = Field(default=0, ge=0)
    """Pictures of each probe with exposures from far too dark to far too bright."""

    mixed_per_probe: int = Field(default=0, ge=0)
    """Pictures of each probe in the light of another one, turned: light adds up, so the sum of
    two probes is a probe."""

    tilt_deg: float = Field(default=0.0, ge=0, le=45)
    """Pictures are taken of maps tilted by up to this angle about a random level axis."""

    lower_bounds: bool = False
    """Also train on probes whose brightest light is clipped: what is at their ceiling may only
    be found too dark. They are never judged on."""

    synthetic: SyntheticRecipe | None = None
    """Rendered and computed light beside the probes."""

    seed: int = 0
    """For the exposures and curves."""

    @property
    def digest(self) -> str:
        """See the module."""
        return digest_of(self.model_dump(mode="json", exclude_defaults=True))


class NetworkRecipe(Settings):
    """The gain networks. Training is short on purpose: longer runs overfit."""

    members: int = Field(default=4, ge=1)
    """Networks in the ensemble."""

    steps: int = Field(default=1000, ge=1)
    """Optimizer steps of each member."""

    batch: int = Field(default=8, ge=1)
    """Pictures per step."""

    learning_rate: float = 2e-3
    """At the start; it falls to zero on a cosine."""

    weight_decay: float = 0.1
    """Of AdamW."""

    dropout: float = 0.3
    """In the code of the whole picture."""

    color_jitter: float = 0.1
    """Standard deviation of the log of the color of the light."""

    ema_decay: float = 0.998
    """Of the average over steps that is released."""

    precision: Precision = "auto"
    """Of the networks' arithmetic in training: bfloat16, or float32; auto takes bfloat16 where the
    device has it. The losses are float32 always."""


class ComponentRecipe(Settings):
    """The component networks."""

    members: int = Field(default=4, ge=1)
    """Networks in the ensemble."""

    steps: int = Field(default=700, ge=1)
    """Optimizer steps of each member."""

    batch: int = Field(default=64, ge=1)
    """Pictures per step."""

    learning_rate: float = 3e-3
    """At the start; it falls to zero on a cosine."""

    weight_decay: float = 0.1
    """Of AdamW."""

    dropout: float = 0.3
    """After each layer."""

    sun_weight: float = 0.2
    """Of the loss of finding the sun among the components."""

    relative: float = Field(default=0.0, ge=0, le=1)
    """How much of the error of irradiance is relative and not of the log."""

    noise: float = 0.15
    """Standard deviation of the noise on the standardized inputs."""

    ema_decay: float = 0.99
    """Of the average over steps that is released."""


class Recipe(Settings):
    """A model from data to release."""

    id: str
    """Of the released model; its folder has this name."""

    architecture: Literal["panokit"] = "panokit"
    """Which network this is a recipe of; see `panokit.train.expandnet_recipe` for the other."""

    task: str = "expand"
    """What the model is for."""

    data: DataRecipe = DataRecipe()
    """The pictures that the gain networks train on."""

    grid_weight: float = Field(default=0.5, ge=0, le=1)
    """How much the gain networks count in the log of a component's energy; the component
    networks are the rest."""

    component_data: DataRecipe | None = None
    """The pictures that the component networks train on, if not the same."""

    network: NetworkRecipe = NetworkRecipe()
    """The gain networks."""

    components: ComponentRecipe = ComponentRecipe()
    """The component networks."""

    @property
    def digest(self) -> str:
        """See the module."""
        return digest_of(self.model_dump(mode="json", exclude_defaults=True))


def read_recipe(path: Path) -> Recipe:
    """The recipe in a TOML file.

    Raises:
        StorageError: If the file cannot be read.
        SettingsError: If it is not TOML, or holds a key or value that a recipe has not.
    """
    return validated(Recipe, read_table(path), path)


def architecture_of(path: Path) -> Architecture:
    """Which architecture the recipe in a TOML file is for.

    Raises:
        StorageError: If the file cannot be read.
        SettingsError: If it is not TOML, or names an architecture that is not known.
    """
    named = read_table(path).get("architecture", "panokit")
    if named == "panokit":
        return "panokit"
    if named == "expandnet":
        return "expandnet"
    raise SettingsError(
        f'{path}: there is no architecture {named!r}; there are "panokit" and "expandnet".'
    )


def read_table(path: Path) -> dict[str, object]:
    """The keys of a TOML file.

    Raises:
        StorageError: If the file cannot be read.
        SettingsError: If it is not TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise StorageError(f"Cannot read the recipe {path}: {error.strerror}.") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SettingsError(f"{path} is not valid TOML: {error}.") from error


def validated(kind: type[_R], table: dict[str, object], path: Path) -> _R:
    """A table as a recipe of this kind.

    Raises:
        SettingsError: If it holds a key or value that such a recipe has not.
    """
    try:
        return kind.model_validate(table)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise SettingsError(f"{path}: {place}: {first['msg']}.") from error

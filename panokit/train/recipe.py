"""Training recipes: everything that decides what a released expansion model is."""

import tomllib
from pathlib import Path

from pydantic import Field, ValidationError

from panokit.errors import SettingsError, StorageError
from panokit.settings import Settings


class DataRecipe(Settings):
    """The pictures to train on."""

    shots_per_probe: int = Field(default=16, ge=1)
    """Pictures taken of each probe with random exposures and curves."""

    wide_per_probe: int = Field(default=0, ge=0)
    """Pictures of each probe with exposures from far too dark to far too bright."""

    mixed_per_probe: int = Field(default=0, ge=0)
    """Pictures of each probe in the light of another one, turned: light adds up, so the sum of
    two probes is a probe."""

    seed: int = 0
    """For the exposures and curves."""


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


def read_recipe(path: Path) -> Recipe:
    """The recipe in a TOML file.

    Raises:
        StorageError: If the file cannot be read.
        SettingsError: If it is not TOML, or holds a key or value that a recipe has not.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise StorageError(f"Cannot read the recipe {path}: {error.strerror}.") from error
    try:
        return Recipe.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise SettingsError(f"{path} is not valid TOML: {error}.") from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise SettingsError(f"{path}: {place}: {first['msg']}.") from error

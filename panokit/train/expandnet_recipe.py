"""The recipe of an ExpandNet: what decides its weights."""

from pathlib import Path
from typing import Literal

from pydantic import Field

from panokit.provenance import digest_of
from panokit.settings import Settings
from panokit.train.recipe import Precision, read_table, validated


class ExpandNetRecipe(Settings):
    """ExpandNet's architecture and loss, trained on crops of photographed probes."""

    architecture: Literal["expandnet"]
    """Says that this is a recipe of ExpandNet."""

    id: str
    """Of the model; its folder has this name."""

    folds: int = Field(default=5, ge=2)
    """How many parts the probes are split into, whole places at a time."""

    held_out: int | None = 0
    """The fold that training never sees; none to train on all probes."""

    shots_per_probe: int = Field(default=4, ge=1)
    """Pictures taken of each probe with random exposures and curves."""

    steps: int = Field(default=1700, ge=1)
    """Optimizer steps. The published training has 840,000."""

    batch: int = Field(default=4, ge=1)
    """Crops per step; 12 in the publication."""

    crop_px: int = Field(default=128, ge=32)
    """Side of a crop as the network sees it; 256 in the publication."""

    smallest_crop_px: int = Field(default=128, ge=32)
    """Side of the smallest crop, at a panorama's width of 1024, before it is resized."""

    largest_crop_px: int = Field(default=512, ge=32, le=512)
    """Side of the largest crop."""

    learning_rate: float = Field(default=3e-4, gt=0)
    """Of Adam, constant; 7e-5 in the publication, which has 500 times the steps."""

    seed: int = 0
    """Of the weights, the pictures and the crops."""

    precision: Precision = "auto"
    """As in `panokit.train.recipe.NetworkRecipe`."""

    @property
    def digest(self) -> str:
        """See `panokit.train.recipe`: what is at its default does not count."""
        return digest_of(self.model_dump(mode="json", exclude_defaults=True))


def read_expandnet_recipe(path: Path) -> ExpandNetRecipe:
    """The recipe in a TOML file.

    Raises:
        StorageError: If the file cannot be read.
        SettingsError: If it is not TOML, or holds a key or value that a recipe has not.
    """
    return validated(ExpandNetRecipe, read_table(path), path)

"""The same experiment, small or large: what a size says, and a recipe at that size.

A recipe under `pipelines/lighting/` says what is compared; a size says how many samples, how wide
and how long, so that all experiments of a suite share it. What the recipe itself says counts more.
"""

from pathlib import Path
from typing import Any

from pydantic import Field

from panokit.errors import StorageError, UsageError
from panokit.settings import Settings
from panokit.shipped import shipped_path
from panokit.train.recipe import read_table
from panokit.train.stereo.recipe import (
    LightingRecipe,
    ScheduleRecipe,
    read_lighting_recipe,
    validated,
)

SUITE = "pipelines/lighting"


class NetworkSize(Settings):
    """How large networks are."""

    input_px: int = Field(default=128, ge=16)
    """Width and height of the views."""

    width: int = Field(default=32, ge=4)
    """Features after the first block."""


class Size(Settings):
    """What all experiments of a suite have in common."""

    seeds: int = Field(default=1, ge=1)
    """How often each network is trained, from other weights and in another order."""

    samples: int = Field(default=0, ge=0)
    """How many training samples are used; all if 0."""

    network: NetworkSize = NetworkSize()
    """How large networks are."""

    schedule: ScheduleRecipe = ScheduleRecipe()
    """How long and how fast they learn."""


def read_size(name: str) -> Size:
    """A size by its name ("pocket", "two-core", "full") or from a TOML file.

    Raises:
        UsageError: If there is no such size.
        SettingsError: If the file holds what a size has not.
    """
    return validated(Size, read_table(_size_path(name)), _size_path(name))


def at_size(path: Path, size: str, seed: int | None = None) -> LightingRecipe:
    """A recipe at a size; its id then says which, such as "dot-product-pocket-s0".

    Args:
        path: The recipe.
        size: As `read_size` takes it; the recipe as it is if empty.
        seed: In place of the recipe's; `id` says it too.

    Raises:
        UsageError: If there is no such size.
        SettingsError: If the recipe holds what recipes have not.
        StorageError: If it cannot be read.
    """
    recipe = read_lighting_recipe(path)
    if not size and seed is None:
        return recipe
    own = read_table(path)
    place = _size_path(size) if size else None
    general = {} if place is None else read_table(place)
    general.pop("seeds", None)
    merged = _merged(general, own)
    chosen = recipe.seed if seed is None else seed
    merged["seed"] = chosen
    named = f"-{place.stem}" if place else ""
    merged["id"] = f"{recipe.id}{named}-s{chosen}"
    return validated(LightingRecipe, merged, path)


def _size_path(name: str) -> Path:
    if name.endswith(".toml"):
        return Path(name)
    try:
        return shipped_path(f"{SUITE}/sizes/{name}.toml")
    except StorageError:
        known = sorted(path.stem for path in shipped_path(f"{SUITE}/sizes").glob("*.toml"))
        raise UsageError(
            f"There is no size {name!r}; there are {', '.join(known)}, or give a TOML file."
        ) from None


def _merged(general: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    """Both tables in one; where both have a key, the own value counts."""
    merged = dict(general)
    for key, value in own.items():
        both = isinstance(value, dict) and isinstance(merged.get(key), dict)
        merged[key] = _merged(merged[key], value) if both else value
    return merged

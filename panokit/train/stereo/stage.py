"""`panokit train` for lighting: a recipe and a dataset in, a model out; or a suite of them."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import nn

from panokit.engine import Engine, LocalEngine
from panokit.errors import UsageError
from panokit.io.files import read_json, write_json
from panokit.records import Receipt
from panokit.train.history import FILE as HISTORY
from panokit.train.stereo.loop import has_converged, train_lighting
from panokit.train.stereo.pack import Pack, open_pack
from panokit.train.stereo.recipe import LightingRecipe, read_lighting_recipe
from panokit.train.stereo.release import release_lighting
from panokit.train.stereo.sizes import at_size, read_size
from panokit.train.team import ALONE, Team

SUMMARY = "training.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class Training:
    """One network of a suite.

    Attributes:
        experiment: The recipe's id, without size and seed.
        recipe: What is trained.
        dataset: The folder of a stereo dataset.
        work: For packs, checkpoints and the history.
        folder: The model's.
    """

    experiment: str
    recipe: LightingRecipe
    dataset: Path
    work: Path
    folder: Path


def plan_suite(
    recipes: Sequence[Path], size: str, dataset: Path, work: Path, out: Path
) -> list[Training]:
    """The networks of a suite: all recipes with the first seed, then all with the next.

    Args:
        recipes: TOML files, or folders of them.
        size: See `panokit.train.stereo.sizes.read_size`.
        dataset: The folder of a stereo dataset.
        work: For packs, checkpoints and histories.
        out: Gets a folder for each model.

    Raises:
        UsageError: If a folder holds no recipe.
    """
    files: list[Path] = []
    for recipe in recipes:
        found = sorted(recipe.glob("*.toml")) if recipe.is_dir() else [recipe]
        if not found:
            raise UsageError(f"There are no recipes in {recipe}.")
        files += found
    return [
        Training(
            experiment=read_lighting_recipe(file).id,
            recipe=(made := at_size(file, size, seed)),
            dataset=dataset,
            work=work,
            folder=out / made.id,
        )
        for seed in range(read_size(size).seeds)
        for file in files
    ]


def train_suite(trainings: Sequence[Training], engine: Engine | None = None) -> list[Receipt]:
    """Train them all, several at a time; those that are done are left as they are.

    A network of this size gains little from a second core, so each has one.

    Args:
        trainings: See `plan_suite`.
        engine: That runs them; one network per core if not given.
    """
    for dataset, size, work, limit in {
        (t.dataset, t.recipe.network.input_px, t.work, t.recipe.samples) for t in trainings
    }:
        # Before the workers come, which would make the same packs side by side.
        _packs(dataset, size, work, limit)
    outcomes = (engine or LocalEngine()).run(train_one, trainings)
    return [outcome for outcome in outcomes if isinstance(outcome, Receipt)]


def train_one(training: Training) -> Receipt:
    """Train one network of a suite, if that is not done yet."""
    recipe, folder = training.recipe, training.folder
    done = folder / SUMMARY
    fresh = not (done.is_file() and read_json(done).get("recipe") == recipe.digest)
    if fresh:
        train_model(recipe, training.dataset, training.work, folder, experiment=training.experiment)
    return Receipt(item=recipe.id, stage="train", path=folder, key=recipe.digest, fresh=fresh)


def train_model(
    recipe: LightingRecipe,
    dataset: Path,
    work: Path,
    folder: Path,
    *,
    team: Team = ALONE,
    experiment: str = "",
) -> None:
    """Train one recipe and write the model and `training.json` to its folder.

    Args:
        recipe: What and how.
        dataset: The folder of a stereo dataset.
        work: For packs, checkpoints and the history; a run that was stopped goes on from there.
        folder: The model's.
        team: That trains it; its first process writes.
        experiment: What the recipe is called without size and seed.
    """
    size = recipe.network.input_px
    if team.leads:
        _packs(dataset, size, work, recipe.samples)
    team.wait()
    training, validation = _packs(dataset, size, work, recipe.samples)
    place = work / "lighting" / f"{recipe.id}-{recipe.digest[:12]}"
    network = train_lighting(recipe, training, validation, place, team=team)
    if team.leads:
        release_lighting(recipe, network, folder)
        summary = _summary(recipe, place, training, network)
        write_json(folder / SUMMARY, {"experiment": experiment or recipe.id, **summary})
    team.wait()


def _packs(dataset: Path, size: int, work: Path, limit: int) -> tuple[Pack, Pack]:
    return (
        open_pack(dataset, "train", size, work, limit),
        open_pack(dataset, "validation", size, work),
    )


def _summary(
    recipe: LightingRecipe, place: Path, training: Pack, network: nn.Module
) -> dict[str, object]:
    """What the training was, for cards and verdicts."""
    lines = [json.loads(line) for line in (place / HISTORY).read_text("utf-8").splitlines()]
    validation = [float(line["validation"]) for line in lines]
    return {
        "schema": "panokit.lighting-training/1",
        "recipe": recipe.digest,
        "seed": recipe.seed,
        "kind": recipe.kind,
        "samples": len(training),
        "places": sorted({str(one) for one in training.places}),
        "input_px": recipe.network.input_px,
        "parameters": sum(weights.numel() for weights in network.parameters()),
        "steps": lines[-1]["step"],
        "epochs": recipe.schedule.epochs,
        "cpu_hours": round(sum(float(line["cpu_s"]) for line in lines) / 3600, 4),
        "torch": str(torch.__version__),
        "converged": has_converged(validation),
        "history": [
            {name: line[name] for name in ("step", "loss", "validation", "ssd")} for line in lines
        ],
    }

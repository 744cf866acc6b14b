"""`panokit train` for lighting: a recipe and a dataset in, a model out."""

import json
from pathlib import Path

from panokit.io.files import write_json
from panokit.train.history import FILE as HISTORY
from panokit.train.stereo.loop import has_converged, train_lighting
from panokit.train.stereo.pack import open_pack
from panokit.train.stereo.recipe import LightingRecipe, read_lighting_recipe
from panokit.train.stereo.release import release_lighting
from panokit.train.team import ALONE, Team


def train_from_recipe(
    recipe_path: Path, dataset: Path, work: Path, *, team: Team = ALONE, out: Path | None = None
) -> Path:
    """Train the recipe on a dataset and write the model.

    Args:
        recipe_path: models/<id>/recipe.toml, or any recipe.
        dataset: The folder of a stereo dataset.
        work: For packs, checkpoints and the history; a run that was stopped goes on from there.
        team: That trains it; its first process writes.
        out: The model's folder; beside the recipe if not given.

    Returns:
        The folder of the model.
    """
    recipe = read_lighting_recipe(recipe_path)
    folder = out or recipe_path.parent
    train_model(recipe, dataset, work, folder, team=team)
    return folder


def train_model(
    recipe: LightingRecipe, dataset: Path, work: Path, folder: Path, *, team: Team = ALONE
) -> None:
    """Train one recipe and write the model and `training.json` to its folder."""
    size = recipe.network.input_px
    if team.leads:
        for split, limit in (("train", recipe.samples), ("validation", 0)):
            open_pack(dataset, split, size, work, limit)
    team.wait()
    training = open_pack(dataset, "train", size, work, recipe.samples)
    validation = open_pack(dataset, "validation", size, work)
    place = work / "lighting" / f"{recipe.id}-{recipe.digest[:12]}"
    network = train_lighting(recipe, training, validation, place, team=team)
    if team.leads:
        release_lighting(recipe, network, folder)
        write_json(folder / "training.json", _summary(recipe, place, len(training)))
    team.wait()


def _summary(recipe: LightingRecipe, place: Path, samples: int) -> dict[str, object]:
    """What the training was, for cards and verdicts."""
    lines = [json.loads(line) for line in (place / HISTORY).read_text("utf-8").splitlines()]
    validation = [float(line["validation"]) for line in lines]
    return {
        "schema": "panokit.lighting-training/1",
        "recipe": recipe.digest,
        "samples": samples,
        "steps": lines[-1]["step"],
        "epochs": recipe.schedule.epochs,
        "converged": has_converged(validation),
        "history": [
            {name: line[name] for name in ("step", "loss", "validation", "ssd")} for line in lines
        ],
    }

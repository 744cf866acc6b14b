"""`panokit train`: a recipe and a folder of probes in, a released model with its scores out."""

import logging
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from panokit.io.files import write_json
from panokit.train.area_rule import fit_area_rule
from panokit.train.crossval import ScoreRow, judge_fold, train_fold
from panokit.train.ensemble import train_ensemble
from panokit.train.examples import Examples, load_examples, make_examples, save_examples
from panokit.train.probes import FOLDS, TrainingProbe, check_rights, read_probes
from panokit.train.recipe import DataRecipe, Recipe, read_recipe
from panokit.train.release import release
from panokit.train.report import summarize

logger = logging.getLogger(__name__)


def train(
    recipe_path: Path,
    probes_folder: Path,
    work: Path,
    *,
    processes: int = 2,
    own_right: str = "",
) -> Path:
    """Train the recipe on all usable probes and release it beside its recipe.

    Everything costly is kept in `work`: a run that was stopped goes on from there.

    Args:
        recipe_path: models/<id>/recipe.toml; the model's files are written to its folder.
        probes_folder: With a manifest.csv, see `panokit.train.probes`.
        work: For examples and checkpoints.
        processes: For making the examples.
        own_right: What gives the right to train with probes whose license does not.

    Returns:
        The folder of the released model.

    Raises:
        LicenseError: If the license of a probe does not permit training.
    """
    recipe = read_recipe(recipe_path)
    probes = read_probes(probes_folder)
    check_rights(probes, own_right)
    examples = cached_examples(probes, recipe.data, work, processes=processes)
    own = _component_examples(probes, recipe, work, processes)
    network = train_ensemble(examples, recipe, work / "all", component_examples=own)
    release(recipe, network, recipe_path.parent)
    logger.info("area rule fitted to all probes: %s", fit_area_rule(examples))
    return recipe_path.parent


def cross_validate(
    recipe_path: Path,
    probes_folder: Path,
    work: Path,
    *,
    fold_members: int | None = None,
    processes: int = 2,
    own_right: str = "",
) -> list[ScoreRow]:
    """Judge the recipe on probes it has not seen and write metrics.json beside it.

    Args:
        recipe_path: models/<id>/recipe.toml.
        probes_folder: With a manifest.csv.
        work: For examples, checkpoints and the folds' models.
        fold_members: Networks of either kind in each fold; the recipe's own if not given.
            Fewer make the experiment cheaper and its scores a little worse.
        processes: For making the examples.
        own_right: What gives the right to train with probes whose license does not.

    Raises:
        LicenseError: If the license of a probe does not permit training.
    """
    recipe = read_recipe(recipe_path)
    if fold_members is not None:
        network = recipe.network.model_copy(update={"members": fold_members})
        components = recipe.components.model_copy(update={"members": fold_members})
        recipe = recipe.model_copy(update={"network": network, "components": components})
    probes = read_probes(probes_folder)
    check_rights(probes, own_right)
    examples = cached_examples(probes, recipe.data, work, processes=processes)
    own = _component_examples(probes, recipe, work, processes)
    rows: list[ScoreRow] = []
    for fold in range(FOLDS):
        model = train_fold(probes, examples, recipe, fold, work, component_examples=own)
        rows += judge_fold(probes, examples, fold, model)
        logger.info("fold %d of %d judged", fold + 1, FOLDS)
    write_json(recipe_path.parent / "metrics.json", metrics_record(recipe, rows))
    return rows


def cached_examples(
    probes: Sequence[TrainingProbe], recipe: DataRecipe, work: Path, *, processes: int = 1
) -> Examples:
    """The recipe's examples, made once and kept in `work`."""
    path = work / f"examples-{recipe.digest[:12]}.npz"
    if not path.exists():
        work.mkdir(parents=True, exist_ok=True)
        save_examples(make_examples(probes, recipe, processes=processes), path)
    return load_examples(path)


def _component_examples(
    probes: Sequence[TrainingProbe], recipe: Recipe, work: Path, processes: int
) -> Examples | None:
    if recipe.component_data is None:
        return None
    return cached_examples(probes, recipe.component_data, work, processes=processes)


def metrics_record(recipe: Recipe, rows: Sequence[ScoreRow]) -> dict[str, Any]:
    """What metrics.json holds: the protocol, the figures, and every single score."""
    return {
        "protocol": "panokit-expansion-1",
        "folds": FOLDS,
        "gain_networks_per_fold": recipe.network.members,
        "component_networks_per_fold": recipe.components.members,
        "recipe_digest": recipe.digest,
        "summary": summarize(rows),
        "rows": [
            {
                "method": row.method,
                "camera": row.camera,
                "probe": row.probe,
                "category": row.category,
                "fold": row.fold,
                **{
                    name: None if value is None else round(value, 4)
                    for name, value in row.score.to_json().items()
                },
            }
            for row in rows
        ],
    }

"""Networks for a cross-validation: for each fold of the probes, one that has not seen it.

They are made here and judged elsewhere: `panokit evaluate expansion --model
'work/expand-2/fold-{fold}'`. What is finished is kept: a run that was stopped goes on.
"""

import logging
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from panokit.errors import RecordError
from panokit.evaluate.predictors import TRAINING_RECORD
from panokit.io.files import read_json, write_json
from panokit.train.ensemble import train_ensemble
from panokit.train.examples import Examples
from panokit.train.expandnet import train_without
from panokit.train.expandnet_recipe import read_expandnet_recipe
from panokit.train.probes import FOLDS, TrainingProbe, assign_folds, check_rights, read_probes
from panokit.train.recipe import Recipe, read_recipe
from panokit.train.release import release
from panokit.train.stage import recipe_examples
from panokit.train.team import ALONE, Team

logger = logging.getLogger(__name__)


def train_folds(
    recipe_path: Path,
    probes_folder: Path,
    work: Path,
    *,
    fold_members: int | None = None,
    processes: int = 2,
    own_right: str = "",
    team: Team = ALONE,
) -> Path:
    """Train a recipe once for each fold, on the probes of the other folds.

    Args:
        recipe_path: models/<id>/recipe.toml.
        probes_folder: With a manifest.csv.
        work: For examples, checkpoints and the folds' models.
        fold_members: Networks of either kind in each fold; the recipe's own if not given.
            Fewer make the experiment cheaper and its scores a little worse.
        processes: For making the examples.
        own_right: What gives the right to train with probes whose license does not.
        team: That trains them, see `panokit.train.team.team_of`; its first process writes.

    Returns:
        work/<id>/fold-{fold}, to give to `panokit evaluate expansion --model`.

    Raises:
        LicenseError: If the license of a probe does not permit training.
    """
    recipe = read_recipe(recipe_path)
    if fold_members is not None:
        grid = recipe.network.model_copy(update={"members": fold_members})
        components = recipe.components.model_copy(update={"members": fold_members})
        recipe = recipe.model_copy(update={"network": grid, "components": components})
    probes = read_probes(probes_folder)
    check_rights(probes, own_right)
    folds = assign_folds(probes, FOLDS)
    folders = {fold: work / recipe.id / f"fold-{fold}" for fold in range(FOLDS)}
    records = {fold: fold_record(recipe, probes, folds != fold) for fold in folders}
    missing = [fold for fold in folders if not _is_done(folders[fold], records[fold])]
    if missing:
        examples, own = recipe_examples(
            recipe, probes, probes_folder, work, processes=processes, own_right=own_right, team=team
        )
    for fold in missing:
        known = np.flatnonzero(folds != fold)
        network = train_ensemble(
            examples.of_probes(known),
            recipe,
            work / "checkpoints" / f"{recipe.id}-{recipe.digest[:12]}-fold-{fold}",
            component_examples=_of(own, known),
            team=team,
        )
        if team.leads:
            release(recipe, network, folders[fold])
            write_json(folders[fold] / TRAINING_RECORD, records[fold])
        team.wait()
        logger.info("fold %d of %d trained", fold + 1, FOLDS)
    return work / recipe.id / "fold-{fold}"


def train_expandnet_folds(
    recipe_path: Path,
    probes_folder: Path,
    work: Path,
    *,
    own_right: str = "",
    team: Team = ALONE,
) -> Path:
    """Train an ExpandNet recipe once for each of its folds; see `train_folds`.

    Returns:
        work/<id>/fold-{fold}/expandnet.onnx.
    """
    recipe = read_expandnet_recipe(recipe_path)
    probes = read_probes(probes_folder)
    for fold in range(recipe.folds):
        own = recipe.model_copy(update={"held_out": fold})
        folder = work / recipe.id / f"fold-{fold}"
        digest = {"recipe_digest": own.digest}
        if not _is_done(folder, digest):
            checkpoints = work / "checkpoints" / f"{recipe.id}-{own.digest[:12]}"
            train_without(own, probes, folder, checkpoints, own_right=own_right, team=team)
            logger.info("fold %d of %d trained", fold + 1, recipe.folds)
    return work / recipe.id / "fold-{fold}" / "expandnet.onnx"


def fold_record(
    recipe: Recipe, probes: Sequence[TrainingProbe], known: np.ndarray
) -> dict[str, Any]:
    """What training.json holds: the recipe, and which probes were seen, by SHA-256."""
    return {
        "recipe_digest": recipe.digest,
        "seen": {
            probe.name: probe.sha256 for probe, seen in zip(probes, known, strict=True) if seen
        },
    }


def _of(examples: Examples | None, probes: np.ndarray) -> Examples | None:
    return None if examples is None else examples.of_probes(probes)


def _is_done(folder: Path, expected: dict[str, Any]) -> bool:
    """Whether a folder's training.json, which is written last, says all that is expected."""
    try:
        found = read_json(folder / TRAINING_RECORD)
    except RecordError:
        return False
    return isinstance(found, dict) and all(found.get(k) == v for k, v in expected.items())

"""`panokit train`: a recipe and a folder of probes in, a released model out."""

from collections.abc import Sequence
from pathlib import Path

from panokit.train.ensemble import train_ensemble
from panokit.train.examples import Examples, load_examples, make_examples, save_examples
from panokit.train.probes import TrainingProbe, check_rights, read_probes
from panokit.train.recipe import DataRecipe, Recipe, read_recipe
from panokit.train.release import release
from panokit.train.sources import other_sources
from panokit.train.team import ALONE, Team


def train(
    recipe_path: Path,
    probes_folder: Path,
    work: Path,
    *,
    processes: int = 2,
    own_right: str = "",
    team: Team = ALONE,
) -> Path:
    """Train the recipe on all usable probes and release it beside its recipe.

    Everything costly is kept in `work`: a run that was stopped goes on from there.

    Args:
        recipe_path: models/<id>/recipe.toml; the model's files are written to its folder.
        probes_folder: With a manifest.csv, see `panokit.train.probes`.
        work: For examples, computed maps, checkpoints and the history.
        processes: For making the examples.
        own_right: What gives the right to train with probes whose license does not.
        team: That trains it, see `panokit.train.team.team_of`; its first process writes.

    Returns:
        The folder of the released model.

    Raises:
        LicenseError: If the license of a probe does not permit training.
    """
    recipe = read_recipe(recipe_path)
    probes = read_probes(probes_folder)
    check_rights(probes, own_right)
    examples, own = recipe_examples(
        recipe, probes, probes_folder, work, processes=processes, own_right=own_right, team=team
    )
    checkpoints = work / "checkpoints" / f"{recipe.id}-{recipe.digest[:12]}-all"
    network = train_ensemble(examples, recipe, checkpoints, component_examples=own, team=team)
    if team.leads:
        release(recipe, network, recipe_path.parent)
    team.wait()
    return recipe_path.parent


def recipe_examples(
    recipe: Recipe,
    probes: Sequence[TrainingProbe],
    probes_folder: Path,
    work: Path,
    *,
    processes: int = 1,
    own_right: str = "",
    team: Team = ALONE,
) -> tuple[Examples, Examples | None]:
    """The examples of the gain networks, and those of the component networks, if not the same.

    Arguments as of `train`.
    """
    both = [recipe.data] if recipe.component_data is None else [recipe.data, recipe.component_data]
    if team.leads:
        for data in both:
            _make_missing(probes, data, probes_folder, work, processes, own_right)
    team.wait()
    loaded = [load_examples(_path_of(data, work)) for data in both]
    return loaded[0], loaded[1] if len(loaded) > 1 else None


def _path_of(recipe: DataRecipe, work: Path) -> Path:
    return work / f"examples-{recipe.digest[:12]}.npz"


def _make_missing(
    probes: Sequence[TrainingProbe],
    recipe: DataRecipe,
    folder: Path,
    work: Path,
    processes: int,
    own_right: str,
) -> None:
    path = _path_of(recipe, work)
    if path.exists():
        return
    work.mkdir(parents=True, exist_ok=True)
    others = other_sources(probes, recipe, folder, work, own_right=own_right)
    save_examples(make_examples(probes, recipe, others=others, processes=processes), path)

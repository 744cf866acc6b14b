"""`panokit train`: a recipe and a folder of probes in, a released model out."""

from collections.abc import Sequence
from pathlib import Path

from panokit.train.ensemble import train_ensemble
from panokit.train.examples import Examples, load_examples, make_examples, save_examples
from panokit.train.probes import TrainingProbe, check_rights, read_probes
from panokit.train.recipe import DataRecipe, Recipe, read_recipe
from panokit.train.release import release


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
    own = component_examples(probes, recipe, work, processes)
    network = train_ensemble(examples, recipe, work / "all", component_examples=own)
    release(recipe, network, recipe_path.parent)
    return recipe_path.parent


def cached_examples(
    probes: Sequence[TrainingProbe], recipe: DataRecipe, work: Path, *, processes: int = 1
) -> Examples:
    """The recipe's examples, made once and kept in `work`."""
    path = work / f"examples-{recipe.digest[:12]}.npz"
    if not path.exists():
        work.mkdir(parents=True, exist_ok=True)
        save_examples(make_examples(probes, recipe, processes=processes), path)
    return load_examples(path)


def component_examples(
    probes: Sequence[TrainingProbe], recipe: Recipe, work: Path, processes: int
) -> Examples | None:
    """The examples of the component networks; None where they learn from the others' own."""
    if recipe.component_data is None:
        return None
    return cached_examples(probes, recipe.component_data, work, processes=processes)

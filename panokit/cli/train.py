"""`panokit train`: a network from its recipe."""

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from panokit.console import Console
from panokit.errors import MissingExtraError


def train(
    recipe: Path,
    /,
    *,
    probes: Path,
    work: Path = Path("work"),
    folds: Annotated[bool, Parameter(negative=())] = False,
    fold_members: int | None = None,
    processes: int = 2,
    own_right: str = "",
) -> int:
    """Train an expansion network from its recipe and release it beside the recipe.

    Stop it whenever you like; the same command goes on. Needs panokit[train].

    Parameters
    ----------
    recipe
        The recipe, for instance models/expand-2/recipe.toml; one called expandnet.toml trains
        ExpandNet's architecture as a baseline, see docs/commands/evaluate.md.
    probes
        A folder of HDR probes with its manifest.csv.
    work
        Where examples and checkpoints are kept.
    folds
        Instead of releasing a model, train one for each fold of the probes that has not seen it, in
        WORK/ID/fold-N, to be judged by: panokit evaluate expansion --model 'WORK/ID/fold-{fold}'
    fold_members
        Networks of either kind in each fold, if fewer than the recipe's will do.
    processes
        Processes for making the examples.
    own_right
        What gives you the right to train with probes whose license does not, in words.
    """
    if find_spec("torch") is None:
        raise MissingExtraError("torch", "train", "Training")
    from panokit.train import stage

    console = Console()
    is_expandnet = recipe.name == "expandnet.toml"
    if folds:
        from panokit.train.folds import train_expandnet_folds, train_folds

        if is_expandnet:
            pattern = train_expandnet_folds(recipe, probes, work, own_right=own_right)
        else:
            pattern = train_folds(
                recipe,
                probes,
                work,
                fold_members=fold_members,
                processes=processes,
                own_right=own_right,
            )
        console.result(f"Judge them with: panokit evaluate expansion --model '{pattern}'")
    elif is_expandnet:
        from panokit.train.expandnet import train_expandnet

        console.result(f"Written: {train_expandnet(recipe, probes, work, own_right=own_right)}")
    else:
        released = stage.train(recipe, probes, work, processes=processes, own_right=own_right)
        console.result(f"Released: {released}")
    return 0

"""`panokit train`: a network from its recipe."""

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from panokit.console import Console
from panokit.errors import MissingExtraError, UsageError


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
    device: Literal["auto", "cpu", "cuda"] = "auto",
) -> int:
    """Train an expansion network from its recipe and release it beside the recipe.

    Stop it whenever you like; the same command goes on. Several processes train together
    under torchrun. Needs panokit[train].

    Parameters
    ----------
    recipe
        The recipe, for instance models/expand-2/recipe.toml; one whose architecture is
        "expandnet" trains ExpandNet as a baseline, see docs/commands/evaluate.md.
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
    device
        What to compute on; auto takes the graphics processor if there is one.
    """
    if find_spec("torch") is None:
        raise MissingExtraError("torch", "train", "Training")
    from panokit.train.recipe import architecture_of
    from panokit.train.team import team_of

    architecture = architecture_of(recipe)
    own = {"processes": processes} if architecture == "panokit" else {}
    if fold_members is not None:
        if not folds or architecture != "panokit":
            raise UsageError("--fold-members goes with --folds and an architecture of panokit's.")
        own["fold_members"] = fold_members
    with team_of(device) as team:
        made = _trainer(architecture, folds)(
            recipe, probes, work, own_right=own_right, team=team, **own
        )
        if not team.leads:
            return 0
        console = Console()
        if folds:
            console.result(f"Judge them with: panokit evaluate expansion --model '{made}'")
        else:
            console.result(f"Released: {made}")
    return 0


def _trainer(architecture: str, folds: bool) -> Callable[..., Path]:
    """The function for what was asked; torch is loaded with it."""
    if folds:
        from panokit.train.folds import train_expandnet_folds, train_folds

        return train_folds if architecture == "panokit" else train_expandnet_folds
    from panokit.train.expandnet import train_expandnet
    from panokit.train.stage import train as train_panokit

    return train_panokit if architecture == "panokit" else train_expandnet

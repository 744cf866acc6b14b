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
    probes: Path | None = None,
    data: Path | None = None,
    size: str = "",
    seed: int | None = None,
    out: Path | None = None,
    work: Path = Path("work"),
    folds: Annotated[bool, Parameter(negative=())] = False,
    fold_members: int | None = None,
    processes: int = 2,
    own_right: str = "",
    device: Literal["auto", "cpu", "cuda"] = "auto",
) -> int:
    """Train a network, or a suite of them, from recipes.

    Recipes of expansion learn from --probes, recipes of lighting from --data. Stop it whenever
    you like; the same command goes on. Several processes train one network together under
    torchrun. Needs panokit[train].

    Parameters
    ----------
    recipe
        The recipe, for instance models/expand-2/recipe.toml or
        pipelines/lighting/dot-product.toml; a folder of lighting recipes is a suite.
    probes
        Of expansion: a folder of HDR probes with its manifest.csv.
    data
        Of lighting: a stereo dataset.
    size
        Of lighting: pocket, two-core or full, or a TOML file; the recipe as it is if not given.
    seed
        Of lighting: train the recipe once, with this seed, and not with all of the size's.
    out
        Of lighting: gets a folder for each model; WORK/models if not given.
    work
        Where examples and checkpoints are kept.
    folds
        Instead of releasing a model, train one for each fold of the probes that has not seen it, in
        WORK/ID/fold-N, to be judged by: panokit evaluate expansion --model 'WORK/ID/fold-{fold}'
    fold_members
        Networks of either kind in each fold, if fewer than the recipe's will do.
    processes
        Processes for making the examples, or networks of a suite that are trained at a time.
    own_right
        What gives you the right to train with probes whose license does not, in words.
    device
        What to compute on; auto takes the graphics processor if there is one.
    """
    if find_spec("torch") is None:
        raise MissingExtraError("torch", "train", "Training")
    from panokit.train.recipe import architecture_of, read_table
    from panokit.train.team import team_of

    if recipe.is_dir() or read_table(recipe).get("task") == "lighting":
        if data is None:
            raise UsageError("Networks that read light learn from a stereo dataset: --data DIR.")
        return _train_lighting(
            recipe, data, size, seed, out or work / "models", work, processes, device
        )
    if probes is None:
        raise UsageError("Expansion networks learn from a folder of HDR probes: --probes DIR.")
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


def _train_lighting(
    recipe: Path,
    data: Path,
    size: str,
    seed: int | None,
    out: Path,
    work: Path,
    processes: int,
    device: Literal["auto", "cpu", "cuda"],
) -> int:
    from panokit.train.stereo.sizes import at_size
    from panokit.train.stereo.stage import plan_suite, train_model, train_suite
    from panokit.train.team import team_of

    console = Console()
    if size and seed is None:
        from panokit.engine import LocalEngine, SerialEngine

        trainings = plan_suite([recipe], size, data, work, out)
        console.note(f"{len(trainings)} networks, {processes} at a time")
        engine = (
            SerialEngine(on_report=console.note)
            if processes == 1
            else LocalEngine(processes, on_report=console.note)
        )
        done = train_suite(trainings, engine)
        fresh = sum(receipt.fresh for receipt in done)
        console.result(f"{fresh} networks trained, {len(done) - fresh} were there already.")
        console.result(f"Judge them with: panokit evaluate {out} --data {data} --out scores")
        return 0
    if recipe.is_dir():
        raise UsageError("A suite needs a size: --size pocket, two-core or full.")
    chosen = at_size(recipe, size, seed)
    with team_of(device) as team:
        train_model(chosen, data, work, out / chosen.id, team=team)
        if team.leads:
            console.result(f"Judge it with: panokit evaluate {out / chosen.id} --data {data} "
                           "--out scores")
    return 0


def _trainer(architecture: str, folds: bool) -> Callable[..., Path]:
    """The function for what was asked; torch is loaded with it."""
    if folds:
        from panokit.train.folds import train_expandnet_folds, train_folds

        return train_folds if architecture == "panokit" else train_expandnet_folds
    from panokit.train.expandnet import train_expandnet
    from panokit.train.stage import train as train_panokit

    return train_panokit if architecture == "panokit" else train_expandnet

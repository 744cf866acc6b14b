"""`panokit train`: a network from its recipe."""

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from panokit.console import Console
from panokit.errors import MissingExtraError, UsageError
from panokit.train.settings import ExpansionTraining, LightingTraining

if TYPE_CHECKING:
    from panokit.engine import Engine
    from panokit.train.team import DeviceName

_FLAT = Parameter(name="*")


def train(
    recipe: Path,
    /,
    *,
    work: Path = Path("work"),
    processes: int = 2,
    device: Literal["auto", "cpu", "cuda"] = "auto",
    expansion: Annotated[ExpansionTraining, _FLAT] = ExpansionTraining(),
    lighting: Annotated[LightingTraining, _FLAT] = LightingTraining(),
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
    work
        Where examples and checkpoints are kept.
    processes
        Processes for making the examples, or networks of a suite that are trained at a time.
    device
        What to compute on; auto takes the graphics processor if there is one.
    """
    if find_spec("torch") is None:
        raise MissingExtraError("torch", "train", "Training")
    from panokit.train.recipe import read_table

    if recipe.is_dir() or read_table(recipe).get("task") == "lighting":
        return _train_lighting(recipe, lighting, work, processes, device)
    return _train_expansion(recipe, expansion, work, processes, device)


def _train_expansion(
    recipe: Path, settings: ExpansionTraining, work: Path, processes: int, device: "DeviceName"
) -> int:
    from panokit.train.recipe import architecture_of
    from panokit.train.team import team_of

    if settings.probes is None:
        raise UsageError("Expansion networks learn from a folder of HDR probes: --probes DIR.")
    architecture = architecture_of(recipe)
    own = {"processes": processes} if architecture == "panokit" else {}
    if settings.fold_members is not None:
        if not settings.folds or architecture != "panokit":
            raise UsageError("--fold-members goes with --folds and an architecture of panokit's.")
        own["fold_members"] = settings.fold_members
    with team_of(device) as team:
        made = _trainer(architecture, settings.folds)(
            recipe, settings.probes, work, own_right=settings.own_right, team=team, **own
        )
        if not team.leads:
            return 0
        console = Console()
        if settings.folds:
            console.result(f"Judge them with: panokit evaluate expansion --model '{made}'")
        else:
            console.result(f"Released: {made}")
    return 0


def _train_lighting(
    recipe: Path, settings: LightingTraining, work: Path, processes: int, device: "DeviceName"
) -> int:
    from panokit.errors import Rejection
    from panokit.train.stereo.recipe import read_lighting_recipe
    from panokit.train.stereo.sizes import at_size
    from panokit.train.stereo.stage import plan_suite, train_model, train_suite, train_together
    from panokit.train.team import team_of

    data, out = settings.data, settings.out or work / "models"
    if data is None:
        raise UsageError("Networks that read light learn from a stereo dataset: --data DIR.")
    console = Console()
    is_suite = bool(settings.size) and settings.seed is None
    if recipe.is_dir() and not is_suite:
        raise UsageError("A suite needs a size, and takes its seeds: --size pocket and no --seed.")
    with team_of(device) as team:
        if not is_suite:
            chosen = at_size(recipe, settings.size, settings.seed)
            experiment = read_lighting_recipe(recipe).id
            train_model(chosen, data, work, out / chosen.id, team=team, experiment=experiment)
            if team.leads:
                _say_how_to_judge(console, out / chosen.id, data)
            return 0
        trainings = plan_suite([recipe], settings.size, data, work, out)
        if team.size > 1 or team.device != "cpu":
            done = train_together(trainings, team)
        else:
            console.note(f"Networks to train: {len(trainings)}, {processes} at a time")
            done = train_suite(trainings, _engine(processes, console))
        if not team.leads:
            return 0
    missing = [outcome for outcome in done if isinstance(outcome, Rejection)]
    for rejection in missing:
        console.note(f"There is no {rejection.item}: {rejection.message}")
    fresh = sum(not isinstance(outcome, Rejection) and outcome.fresh for outcome in done)
    there = len(done) - fresh - len(missing)
    console.result(f"Networks trained: {fresh}, there already: {there}, missing: {len(missing)}")
    if there + fresh:
        _say_how_to_judge(console, out, data)
    return 1 if missing else 0


def _engine(processes: int, console: Console) -> "Engine":
    from panokit.engine import LocalEngine, SerialEngine

    if processes == 1:
        return SerialEngine(on_report=console.note)
    return LocalEngine(processes, on_report=console.note)


def _say_how_to_judge(console: Console, models: Path, data: Path) -> None:
    console.result(f"Judge with: panokit evaluate {models} --data {data} --out scores")


def _trainer(architecture: str, folds: bool) -> Callable[..., Path]:
    """The function for what was asked; torch is loaded with it."""
    if folds:
        from panokit.train.folds import train_expandnet_folds, train_folds

        return train_folds if architecture == "panokit" else train_expandnet_folds
    from panokit.train.expandnet import train_expandnet
    from panokit.train.stage import train as train_panokit

    return train_panokit if architecture == "panokit" else train_expandnet

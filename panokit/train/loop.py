"""The training loops: short runs, the average of the weights is what counts."""

import logging
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from panokit.expand.component_features import COMPONENT_FEATURES
from panokit.networks.component_net import ComponentNet
from panokit.networks.gain_net import GainNet
from panokit.train.augment import tint, turn
from panokit.train.examples import Examples
from panokit.train.history import NOTE_EVERY, History
from panokit.train.losses import GridLoss, component_loss, sun_loss
from panokit.train.recipe import ComponentRecipe, NetworkRecipe
from panokit.train.run import Run, start
from panokit.train.team import ALONE, Team

CHECKPOINT_EVERY = 100
_COMPONENT_INPUTS = ("ldr_energy", "energy", "spread", "vector", "rest", "lower")

logger = logging.getLogger(__name__)


def train_gain_net(
    examples: Examples,
    recipe: NetworkRecipe,
    *,
    seed: int,
    checkpoint: Path | None = None,
    team: Team = ALONE,
) -> GainNet:
    """Train one member of the ensemble; the random choices of a step depend on (seed, step).

    Args:
        examples: To learn from.
        recipe: How.
        seed: Of this member.
        checkpoint: Continued from if it exists, and written every 100 steps and at the end;
            beside it goes the history.
        team: That trains it.
    """
    torch.manual_seed(seed)
    network = GainNet(dropout=recipe.dropout)
    run = start(network, recipe, team, seed=seed)
    run.resume(checkpoint)
    loss_of = GridLoss().to(team.device)
    history = _history(f"gain-{seed}", run, checkpoint)
    network.train()
    while run.step < recipe.steps:
        random = np.random.default_rng([seed, run.step])
        torch.manual_seed(_seed_of_step(seed, run, team))
        batch = [each.to(team.device) for each in _grid_batch(examples, recipe, random, team)]
        grid, clear, burnt, ceiling = batch
        # bfloat16 halves the time of a step on processors that have it; the loss stays exact.
        with team.autocast(recipe.precision):
            log_gain, slopes = network(grid)
        terms = loss_of(grid, log_gain.float(), slopes.float(), clear, burnt, ceiling)
        _step(run, terms, history, checkpoint, recipe.steps)
    history.close()
    run.finish()
    return network


def train_component_net(
    examples: Examples,
    recipe: ComponentRecipe,
    *,
    seed: int,
    checkpoint: Path | None = None,
    team: Team = ALONE,
) -> ComponentNet:
    """Train one member of the ensemble; arguments as of `train_gain_net`."""
    torch.manual_seed(seed)
    some = np.flatnonzero(examples.ldr_energy[:, 0] > 0)
    known = examples.at(some)
    tensors = {name: torch.from_numpy(getattr(known, name)) for name in _COMPONENT_INPUTS}
    features, sun = torch.from_numpy(known.features), torch.from_numpy(known.sun)
    network = ComponentNet(COMPONENT_FEATURES, dropout=recipe.dropout)
    network.standardize_by(features[tensors["ldr_energy"] > 0])
    run = start(network, recipe, team, seed=seed)
    run.resume(checkpoint)
    history = _history(f"components-{seed}", run, checkpoint)
    network.train()
    while run.step < recipe.steps:
        if team != ALONE:
            # A checkpoint has the random state of one CPU, which goes on from step to step.
            torch.manual_seed(_seed_of_step(seed, run, team))
        picked = torch.from_numpy(team.part(known.draw(recipe.batch, run.random)))
        batch = {name: tensor[picked].to(team.device) for name, tensor in tensors.items()}
        log_gain, logit = network(features[picked].to(team.device), recipe.noise)
        found = sun_loss(logit, sun[picked].to(team.device), batch["ldr_energy"])
        terms = component_loss(log_gain, **batch, relative=recipe.relative)
        terms["sun"] = recipe.sun_weight * found
        _step(run, terms, history, checkpoint, recipe.steps)
    history.close()
    run.finish()
    return network


def _seed_of_step(seed: int, run: Run, team: Team) -> int:
    return seed * 1_000_003 + run.step + 7919 * team.rank


def _history(name: str, run: Run, checkpoint: Path | None) -> History:
    folder = checkpoint.parent if checkpoint is not None and run.team.leads else None
    return History(folder, name, run.step)


def _step(
    run: Run, terms: dict[str, Tensor], history: History, checkpoint: Path | None, steps: int
) -> None:
    rate = run.learning_rate
    loss = sum(terms.values(), start=torch.zeros((), device=run.team.device))
    run.advance(loss)
    if run.step % NOTE_EVERY == 0 or run.step == steps:
        values = {name: float(term.detach()) for name, term in terms.items()}
        history.note(run.step, {"loss": float(loss.detach()), **values}, rate)
    if run.step % CHECKPOINT_EVERY == 0 or run.step == steps:
        logger.info("step %d of %d, loss %.3f", run.step, steps, float(loss.detach()))
        if checkpoint is not None:
            run.save(checkpoint)


def _grid_batch(
    examples: Examples, recipe: NetworkRecipe, random: np.random.Generator, team: Team
) -> tuple[Tensor, ...]:
    """This process's part of a step's batch: grid, clear, burnt, ceiling."""
    picked = examples.draw(recipe.batch, random)
    width = examples.grid.shape[-1]
    columns = random.integers(width, size=recipe.batch)
    flips = random.random(recipe.batch) < 0.5
    log_color = random.normal(0, recipe.color_jitter, (recipe.batch, 3))
    part = team.part(np.arange(recipe.batch))
    picked = picked[part]
    maps = np.concatenate(
        [
            examples.grid[picked],
            examples.clear[picked],
            examples.burnt[picked],
            examples.ceiling[picked][:, None],
        ],
        axis=1,
    )
    turned = turn(torch.from_numpy(maps).float(), columns[part].tolist(), flips[part].tolist())
    grid, clear, burnt, ceiling = turned.split([examples.grid.shape[1], 3, 3, 1], dim=1)
    tinted = tint(grid, clear, burnt, torch.from_numpy(log_color[part]).float())
    return (*tinted, ceiling[:, 0])

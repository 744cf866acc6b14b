"""The training loops: short runs, the average of the weights is what counts."""

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn

from panokit.errors import ModelError
from panokit.expand.component_features import COMPONENT_FEATURES
from panokit.io.files import atomic_write
from panokit.networks.component_net import ComponentNet
from panokit.networks.gain_net import GainNet
from panokit.train.augment import tint, turn
from panokit.train.examples import Examples
from panokit.train.losses import GridLoss, component_loss, sun_loss
from panokit.train.recipe import ComponentRecipe, NetworkRecipe

CHECKPOINT_EVERY = 100

logger = logging.getLogger(__name__)


@dataclass(slots=True, eq=False)
class _Run:
    """Everything that changes while a network trains; a checkpoint is all of it."""

    network: nn.Module
    optimizer: torch.optim.Optimizer
    schedule: torch.optim.lr_scheduler.LRScheduler
    average: AveragedModel
    step: int = 0

    def save(self, path: Path) -> None:
        state = {
            "network": self.network.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "schedule": self.schedule.state_dict(),
            "average": self.average.state_dict(),
            "step": self.step,
        }
        with atomic_write(path) as temporary:
            torch.save(state, temporary)

    def resume(self, path: Path) -> None:
        state = torch.load(path, weights_only=True)
        self.network.load_state_dict(state["network"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.schedule.load_state_dict(state["schedule"])
        self.average.load_state_dict(state["average"])
        self.step = state["step"]


def train_gain_net(
    examples: Examples, recipe: NetworkRecipe, *, seed: int, checkpoint: Path | None = None
) -> GainNet:
    """Train one member of the ensemble; the random choices of a step depend on (seed, step).

    Args:
        examples: To learn from.
        recipe: How.
        seed: Of this member.
        checkpoint: Continued from if it exists, and written every 100 steps.
    """
    torch.manual_seed(seed)
    network = GainNet(dropout=recipe.dropout)
    run = _start(network, recipe)
    if checkpoint is not None and checkpoint.exists():
        run.resume(checkpoint)
    loss_of = GridLoss()
    network.train()
    while run.step < recipe.steps:
        random = np.random.default_rng([seed, run.step])
        torch.manual_seed(seed * 1_000_003 + run.step)
        grid, clear, burnt = _grid_batch(examples, recipe, random)
        # bfloat16 halves the time of a step on processors that have it; the loss stays exact.
        with torch.autocast("cpu", dtype=torch.bfloat16):
            log_gain, slopes = network(grid)
        loss = loss_of(grid, log_gain.float(), slopes.float(), clear, burnt)
        _step(run, loss)
        if run.step % CHECKPOINT_EVERY == 0:
            logger.info("gain net %d step %d loss %.3f", seed, run.step, float(loss.detach()))
            if checkpoint is not None:
                run.save(checkpoint)
    _take_average(run)
    return network.eval()


def train_component_net(examples: Examples, recipe: ComponentRecipe, *, seed: int) -> ComponentNet:
    """Train one member of the ensemble; it takes seconds, so there are no checkpoints."""
    torch.manual_seed(seed)
    some = np.flatnonzero(examples.ldr_energy[:, 0] > 0)
    tensors = {
        name: torch.from_numpy(getattr(examples, name)[some])
        for name in ("features", "ldr_energy", "energy", "spread", "vector", "rest")
    }
    tensors["sun"] = torch.from_numpy(examples.sun[some])
    network = ComponentNet(COMPONENT_FEATURES, dropout=recipe.dropout)
    network.standardize_by(tensors["features"][tensors["ldr_energy"] > 0])
    run = _start(network, recipe)
    network.train()
    random = np.random.default_rng(seed)
    while run.step < recipe.steps:
        picked = torch.from_numpy(random.integers(len(some), size=recipe.batch))
        batch = {name: tensor[picked] for name, tensor in tensors.items()}
        log_gain, logit = network(batch.pop("features"), recipe.noise)
        sun = sun_loss(logit, batch.pop("sun"), batch["ldr_energy"])
        light = component_loss(log_gain, **batch, relative=recipe.relative)
        _step(run, light + recipe.sun_weight * sun)
    _take_average(run)
    return network.eval()


def _start(network: nn.Module, recipe: NetworkRecipe | ComponentRecipe) -> _Run:
    optimizer = torch.optim.AdamW(
        network.parameters(), lr=recipe.learning_rate, weight_decay=recipe.weight_decay
    )
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, recipe.steps)
    # An average that remembers more than the run is long would release its first weights.
    decay = min(recipe.ema_decay, 1 - 5 / max(recipe.steps, 10))
    average = AveragedModel(network, multi_avg_fn=get_ema_multi_avg_fn(decay))
    return _Run(network, optimizer, schedule, average)


def _step(run: _Run, loss: Tensor) -> None:
    run.optimizer.zero_grad(set_to_none=True)
    loss.backward()
    nn.utils.clip_grad_norm_(run.network.parameters(), 1.0)
    run.optimizer.step()
    run.schedule.step()
    run.average.update_parameters(run.network)
    run.step += 1


def _grid_batch(
    examples: Examples, recipe: NetworkRecipe, random: np.random.Generator
) -> tuple[Tensor, Tensor, Tensor]:
    picked = random.integers(len(examples.probe), size=recipe.batch)
    width = examples.grid.shape[-1]
    columns = random.integers(width, size=recipe.batch).tolist()
    flips = (random.random(recipe.batch) < 0.5).tolist()
    maps = np.concatenate(
        [examples.grid[picked], examples.clear[picked], examples.burnt[picked]], axis=1
    )
    turned = turn(torch.from_numpy(maps).float(), columns, flips)
    grid, clear, burnt = turned.split([examples.grid.shape[1], 3, 3], dim=1)
    log_color = torch.from_numpy(random.normal(0, recipe.color_jitter, (recipe.batch, 3))).float()
    return tint(grid, clear, burnt, log_color)


def _take_average(run: _Run) -> None:
    """Give the network the average of its weights over the steps.

    Raises:
        ModelError: If training diverged.
    """
    average = run.average.module.state_dict()
    if not all(bool(torch.isfinite(value).all()) for value in average.values()):
        raise ModelError("Training diverged: weights are not finite. Lower the learning rate.")
    run.network.load_state_dict(average)

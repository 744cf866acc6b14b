"""The training loop: epochs over a pack, the average of the weights validated after each."""

import json
import logging
import math
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from panokit.engine import report
from panokit.networks.stereo.coding import encode
from panokit.train.history import FILE, History
from panokit.train.run import Run, start
from panokit.train.stereo.losses import MapLoss
from panokit.train.stereo.pack import Pack
from panokit.train.stereo.recipe import LightingRecipe
from panokit.train.stereo.tasks import batch_of, build_network
from panokit.train.team import ALONE, Team

# A training has converged when its last fifth brought less than this.
CONVERGED_BELOW = 0.01
# Of the learning rate: what steps beyond the schedule are made with.
TAIL_RATE = 0.05
_VALIDATION_BATCH = 64

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Steps:
    """The schedule as `panokit.train.run` takes it."""

    steps: int
    learning_rate: float
    weight_decay: float
    ema_decay: float


def train_lighting(
    recipe: LightingRecipe,
    training: Pack,
    validation: Pack,
    work: Path,
    *,
    team: Team = ALONE,
) -> nn.Module:
    """Train a network; stopped and started again it comes out the same, bit by bit.

    Args:
        recipe: What and how.
        training: To learn from.
        validation: Looked at after each epoch, never learned from.
        work: Gets checkpoint.pt and history.jsonl.
        team: That trains it.

    Returns:
        The network with the average of its weights, on the CPU.
    """
    torch.manual_seed(recipe.seed)
    # Processors do convolutions in half the time where the channels of a pixel lie together.
    network = build_network(recipe)
    network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    per_epoch = max(1, len(training) // recipe.schedule.batch)
    schedule = recipe.schedule
    run = start(
        network,
        Steps(
            steps=per_epoch * schedule.epochs,
            learning_rate=schedule.learning_rate,
            weight_decay=schedule.weight_decay,
            ema_decay=schedule.ema_decay,
        ),
        team,
        seed=recipe.seed,
    )
    checkpoint = work / "checkpoint.pt"
    run.resume(checkpoint)
    losses = _losses_until(work / FILE, run.step)
    history = History(work if team.leads else None, recipe.id, run.step)
    loss_of = MapLoss(recipe.loss, recipe.coding.coding)
    for epoch in range(run.step // per_epoch, schedule.epochs + schedule.tail_epochs):
        if epoch >= schedule.epochs:
            if team.agreed(has_converged(losses)):
                break
            run.hold(TAIL_RATE * schedule.learning_rate)
        began = time.process_time()
        terms = _epoch(run, recipe, training, loss_of, epoch, per_epoch)
        found = validate(run.average.module, recipe, validation, loss_of, team)
        found["cpu_s"] = time.process_time() - began
        losses.append(found["validation"])
        history.note(run.step, {**terms, **found}, run.learning_rate)
        report(
            f"{recipe.id}: epoch {epoch + 1} of {max(schedule.epochs, epoch + 1)}, "
            f"validation {found['validation']:.4f}"
        )
        logger.info("epoch %d, validation %.4f", epoch + 1, found["validation"])
        run.save(checkpoint)
    history.close()
    run.finish()
    network.to(memory_format=torch.contiguous_format)  # type: ignore[call-overload]
    return network


def _losses_until(path: Path, step: int) -> list[float]:
    """The validation losses of a run that goes on after a step, epoch by epoch."""
    if not path.exists() or step == 0:
        return []
    lines = [
        json.loads(line) for line in path.read_text("utf-8").splitlines() if line.endswith("}")
    ]
    return [float(line["validation"]) for line in lines if line["step"] <= step]


def _epoch(
    run: Run,
    recipe: LightingRecipe,
    pack: Pack,
    loss_of: MapLoss,
    epoch: int,
    per_epoch: int,
) -> dict[str, float]:
    """One epoch; the means of the loss and its terms."""
    order = np.random.default_rng([recipe.seed, epoch]).permutation(len(pack))
    sums: dict[str, float] = {}
    run.network.train()
    for step in range(per_epoch):
        picked = order[step * recipe.schedule.batch : (step + 1) * recipe.schedule.batch]
        picked = run.team.part(np.sort(picked))
        inputs, truth = batch_of(recipe, pack, picked, _seed(recipe, epoch, step))
        with run.team.autocast(recipe.schedule.precision):
            code = run.network(*_ready(inputs, run.team))
        terms = loss_of(code.float(), truth.to(run.team.device))
        loss = torch.stack(list(terms.values())).sum()
        run.advance(loss)
        for name, value in {"loss": loss, **terms}.items():
            sums[name] = sums.get(name, 0.0) + float(value.detach())
    return {name: value / per_epoch for name, value in sums.items()}


@torch.inference_mode()
def validate(
    network: nn.Module, recipe: LightingRecipe, pack: Pack, loss_of: MapLoss, team: Team
) -> dict[str, float]:
    """The loss and the thesis's SSD, the sum of squared differences of code values, per sample."""
    network.eval()
    totals = {"validation": 0.0, "ssd": 0.0}
    for first in range(0, len(pack), _VALIDATION_BATCH):
        picked = np.arange(first, min(first + _VALIDATION_BATCH, len(pack)))
        inputs, truth = batch_of(_plain(recipe), pack, picked, 0)
        with team.autocast(recipe.schedule.precision):
            code = network(*_ready(inputs, team))
        code = code.float().cpu()
        terms = loss_of(code, truth)
        totals["validation"] += float(torch.stack(list(terms.values())).sum()) * len(picked)
        wanted = encode(truth, recipe.coding.coding)
        totals["ssd"] += float((code - wanted).square().sum())
    return {name: value / len(pack) for name, value in totals.items()}


def has_converged(validation: list[float]) -> bool:
    """Whether the validation loss fell by less than 1 % over the last fifth of the epochs.

    The least loss until then is compared with the least of all, so that one lucky epoch does
    not make it look unfinished.
    """
    before = math.ceil(len(validation) * 0.8)
    if before < 1 or before == len(validation):
        return False
    earlier = min(validation[:before])
    return (earlier - min(validation)) / earlier < CONVERGED_BELOW


def _ready(inputs: Mapping[str, Tensor], team: Team) -> list[Tensor]:
    """Pictures in [-1, 1]; of reflectance maps validity stays 0 or 1."""
    return [2 * tensor.to(team.device) - 1 for tensor in inputs.values()]


def _plain(recipe: LightingRecipe) -> LightingRecipe:
    """The recipe without what varies pictures in training."""
    schedule = recipe.schedule.model_copy(update={"swap_views": False})
    return recipe.model_copy(update={"schedule": schedule})


def _seed(recipe: LightingRecipe, epoch: int, step: int) -> int:
    return (recipe.seed * 1_000_003 + epoch) * 100_003 + step

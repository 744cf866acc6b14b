"""A network in training: all that changes from step to step, and its checkpoint."""

from dataclasses import dataclass
from pathlib import Path
from pickle import UnpicklingError
from typing import Any, Protocol

import numpy as np
import torch
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn

from panokit.errors import ModelError
from panokit.io.files import atomic_write
from panokit.train.team import Team


class Schedule(Protocol):
    """What the recipes of all kinds of network say of their steps."""

    @property
    def steps(self) -> int:
        """Of the optimizer."""

    @property
    def learning_rate(self) -> float:
        """At the start."""

    @property
    def weight_decay(self) -> float:
        """Of AdamW."""

    @property
    def ema_decay(self) -> float:
        """Of the average over steps."""


@dataclass(slots=True, eq=False)
class Run:
    """Everything that changes while a network trains; a checkpoint is all of it.

    Attributes:
        network: On the team's device.
        optimizer: Of its weights.
        schedule: Of the learning rate.
        average: Of the weights over the steps.
        team: That trains it.
        random: What the batches are drawn with, where that goes on from step to step.
        step: How many were done.
    """

    network: nn.Module
    optimizer: torch.optim.Optimizer
    schedule: torch.optim.lr_scheduler.LRScheduler
    average: AveragedModel
    team: Team
    random: np.random.Generator
    step: int = 0

    @property
    def learning_rate(self) -> float:
        """Of the next step."""
        return float(self.optimizer.param_groups[0]["lr"])

    def advance(self, loss: Tensor) -> None:
        """One step of the optimizer, with the gradients of the whole team.

        Gradients are cut to a length of 1.
        """
        self.optimizer.zero_grad(set_to_none=True)
        loss.backward()
        self.team.average_gradients(self.network)
        nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
        self.optimizer.step()
        self.schedule.step()
        self.average.update_parameters(self.network)
        self.step += 1

    def hold(self, learning_rate: float) -> None:
        """Make all steps from here on with one learning rate."""
        for group in self.optimizer.param_groups:
            group["lr"] = learning_rate
        self.schedule = torch.optim.lr_scheduler.ConstantLR(self.optimizer, 1, total_iters=0)

    def save(self, path: Path) -> None:
        """Write the checkpoint, random states included; only the team's first process does."""
        if not self.team.leads:
            return
        state = {
            "network": self.network.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "schedule": self.schedule.state_dict(),
            "average": self.average.state_dict(),
            "step": self.step,
            "torch_random": torch.get_rng_state(),
            "random": self.random.bit_generator.state,
        }
        with atomic_write(path) as temporary:
            torch.save(state, temporary)

    def resume(self, path: Path | None) -> None:
        """Go on from a checkpoint, if there is one.

        Raises:
            ModelError: If it is damaged or of another network.
        """
        if path is None or not path.exists():
            return
        try:
            state: dict[str, Any] = torch.load(path, weights_only=True, map_location="cpu")
            self.network.load_state_dict(state["network"])
            self.optimizer.load_state_dict(state["optimizer"])
            self.schedule.load_state_dict(state["schedule"])
            self.average.load_state_dict(state["average"])
            self.step = state["step"]
            torch.set_rng_state(state["torch_random"])
            self.random.bit_generator.state = state["random"]
        except (KeyError, RuntimeError, ValueError, EOFError, UnpicklingError) as error:
            raise ModelError(
                f"The checkpoint {path} does not fit this recipe or is damaged "
                f"({type(error).__name__}). Delete it and train again."
            ) from error

    def finish(self) -> None:
        """Give the network the average of its weights over the steps, on the CPU.

        Raises:
            ModelError: If training diverged.
        """
        average = self.average.module.state_dict()
        if not all(bool(torch.isfinite(value).all()) for value in average.values()):
            raise ModelError("Training diverged: weights are not finite. Lower the learning rate.")
        self.network.load_state_dict(average)
        self.network.cpu().eval()


def start(network: nn.Module, recipe: Schedule, team: Team, *, seed: int) -> Run:
    """A network at its first step: AdamW, the learning rate falling to zero on a cosine."""
    network = network.to(team.device)
    optimizer = torch.optim.AdamW(
        network.parameters(), lr=recipe.learning_rate, weight_decay=recipe.weight_decay
    )
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, recipe.steps)
    # An average that remembers more than the run is long would release its first weights.
    decay = min(recipe.ema_decay, 1 - 5 / max(recipe.steps, 10))
    average = AveragedModel(network, multi_avg_fn=get_ema_multi_avg_fn(decay))
    random = np.random.default_rng(seed)
    return Run(network, optimizer, schedule, average, team, random)

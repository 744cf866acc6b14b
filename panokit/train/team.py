"""The processes that train one network together: one alone, or those that torchrun started.

Every process draws the same batch and works on its own part of it; the gradients are then
averaged, so all hold the same weights at every step. The first process alone writes files.
"""

import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from datetime import timedelta
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import distributed, nn

from panokit.errors import SettingsError, UsageError
from panokit.train.recipe import Precision

DeviceName = Literal["auto", "cpu", "cuda"]
# The others wait this long while the first one makes the examples.
_PATIENCE = timedelta(hours=12)


@dataclass(frozen=True, slots=True, kw_only=True)
class Team:
    """One process's place among those that train together.

    Attributes:
        rank: Of this process, from 0.
        size: How many there are.
        device: That this process computes on: "cpu", "cuda:0", ...
    """

    rank: int = 0
    size: int = 1
    device: str = "cpu"

    @property
    def leads(self) -> bool:
        """Whether this process writes the files."""
        return self.rank == 0

    def part(self, picked: NDArray[np.int64]) -> NDArray[np.int64]:
        """This process's part of a batch that all have drawn alike.

        Raises:
            SettingsError: If the batch cannot be divided evenly.
        """
        if len(picked) % self.size:
            raise SettingsError(
                f"A batch of {len(picked)} cannot be divided among {self.size} processes. Change "
                "the recipe's batch or torchrun's --nproc-per-node."
            )
        return picked[self.rank :: self.size]

    def average_gradients(self, network: nn.Module) -> None:
        """Give every process the mean of all gradients."""
        if self.size == 1:
            return
        gradients = [p.grad for p in network.parameters() if p.grad is not None]
        together = torch.cat([gradient.flatten() for gradient in gradients])
        distributed.all_reduce(together)
        together /= self.size
        parts = together.split([gradient.numel() for gradient in gradients])
        for gradient, part in zip(gradients, parts, strict=True):
            gradient.copy_(part.view_as(gradient))

    def agreed(self, verdict: bool) -> bool:
        """The first process's verdict, for all of them.

        What one process finds, such as a validation loss, is not bit by bit what another does;
        were each to go by its own, one would stop and the others wait for it.
        """
        if self.size == 1:
            return verdict
        told = torch.tensor([int(verdict)], device=self.device)
        distributed.broadcast(told, src=0)
        return bool(told.item())

    def wait(self) -> None:
        """Until all have come here."""
        if self.size > 1:
            distributed.barrier()

    def autocast(self, precision: Precision) -> AbstractContextManager[object]:
        """The arithmetic that a recipe asks for, on this device."""
        kind = torch.device(self.device).type
        has_it = kind == "cpu" or torch.cuda.is_bf16_supported()
        if precision == "fp32" or (precision == "auto" and not has_it):
            return nullcontext()
        return torch.autocast(kind, dtype=torch.bfloat16)


# Alone, on the CPU.
ALONE = Team()


@contextmanager
def team_of(device: DeviceName = "auto") -> Iterator[Team]:
    """The team that this process is in: torchrun's, if it was started by torchrun.

    Args:
        device: To compute on; auto takes the graphics processor if there is one.

    Raises:
        UsageError: If there is no such device.
    """
    size = int(os.environ.get("WORLD_SIZE", "1"))
    rank, local = (int(os.environ.get(name, "0")) for name in ("RANK", "LOCAL_RANK"))
    place = _device(device, local)
    if size == 1:
        yield Team(device=place)
        return
    backend = "nccl" if place.startswith("cuda") else "gloo"
    distributed.init_process_group(backend, timeout=_PATIENCE)
    try:
        yield Team(rank=rank, size=size, device=place)
    finally:
        distributed.destroy_process_group()


def _device(name: DeviceName, local_rank: int) -> str:
    has_cuda = torch.cuda.is_available()
    if name == "cuda" and not has_cuda:
        raise UsageError("torch finds no CUDA device here. Train with --device cpu.")
    return f"cuda:{local_rank}" if has_cuda and name != "cpu" else "cpu"

"""In which order samples are read: shuffled, shared by processes, resumable at any place."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError


class ShardSampler:
    """The numbers of samples, one epoch in a shuffled order, for one of several processes.

    The shards come in a random order and their samples are shuffled within a window, so that
    samples read one after the other lie near each other on the disk; a window as large as the
    dataset shuffles all. The order depends on the seed and the epoch alone: every process works
    out the same one and takes every `world`-th sample of it. So each sample comes exactly once
    in an epoch over all processes, and a run goes on from any place, also with another number
    of processes: by `start`.

    It is a sampler of `torch.utils.data.DataLoader`: `DataLoader(dataset, sampler=sampler)`.

    Args:
        shard_sizes: How many samples each shard has: `StereoDataset.shard_sizes`.
        rank: Which process this is, from 0.
        world: How many there are.
        seed: Of the order.
        epoch: Each epoch has its own order.
        start: How many samples of this epoch all processes together have taken already.
        window: How many samples are shuffled together.
        even: Leave out the last samples of the order (less than `world` of them) so that all
            processes get equally many, as training in lockstep needs.
    """

    def __init__(
        self,
        shard_sizes: Sequence[int],
        *,
        rank: int = 0,
        world: int = 1,
        seed: int = 0,
        epoch: int = 0,
        start: int = 0,
        window: int = 4096,
        even: bool = False,
    ) -> None:
        if not 0 <= rank < world:
            raise UsageError(f"Rank {rank} of {world} processes: it goes from 0 to {world - 1}.")
        if window < 1 or seed < 0 or any(size < 0 for size in shard_sizes):
            raise UsageError("Windows and shards have samples, and seeds are not negative.")
        self.shard_sizes = tuple(int(size) for size in shard_sizes)
        self.rank, self.world, self.seed = rank, world, seed
        self.window, self.even = window, even
        self.set_epoch(epoch, start)

    def set_epoch(self, epoch: int, start: int = 0) -> None:
        """Go to an epoch, at its beginning or where it was left.

        Args:
            epoch: From 0.
            start: How many of its samples all processes together have taken already.
        """
        if epoch < 0 or start < 0:
            raise UsageError(f"Epoch {epoch} and start {start} must not be negative.")
        self.epoch, self.start = epoch, start

    def __iter__(self) -> Iterator[int]:
        return iter(self._own().tolist())

    def __len__(self) -> int:
        left = max(0, self._total() - self.start)
        return len(range(self.rank, left, self.world))

    def order(self) -> NDArray[np.int64]:
        """The whole epoch's order, (N,); the same for every process."""
        rng = np.random.default_rng([self.seed, self.epoch])
        ends = np.cumsum(self.shard_sizes)
        shards = [
            np.arange(end - size, end) for end, size in zip(ends, self.shard_sizes, strict=True)
        ]
        parts = [shards[number] for number in rng.permutation(len(shards))]
        order = np.concatenate([np.zeros(0, np.int64), *parts]).astype(np.int64)
        for first in range(0, len(order), self.window):
            rng.shuffle(order[first : first + self.window])
        return order

    def _own(self) -> NDArray[np.int64]:
        return self.order()[: self._total()][self.start :][self.rank :: self.world]

    def _total(self) -> int:
        total = sum(self.shard_sizes)
        if self.even:
            left = max(0, total - self.start)
            total -= left % self.world
        return total

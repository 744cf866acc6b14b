"""Where everything of a dataset lies, and which samples go into which shard.

DIR/dataset.json              what was asked for
DIR/shards/train-00000.tar    samples, with train-00000.json, written last
DIR/index.parquet             one row for each sample
DIR/README.md, sheet.jpg      the card
DIR/failures.jsonl            attempts that gave no sample, and why
DIR/log.jsonl                 what happened when; the only file that knows the clock
DIR/work/                     samples of unfinished shards, and maps at their working size
"""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from panokit.dataset.sample import SPLITS
from panokit.errors import UsageError

LOCK = ".dataset.lock"


@dataclass(frozen=True, slots=True)
class DatasetFolder:
    """The paths of one dataset.

    Attributes:
        root: The folder.
    """

    root: Path

    @property
    def shards(self) -> Path:
        """The tar files and their records."""
        return self.root / "shards"

    @property
    def work(self) -> Path:
        """What is not finished; empty when all is."""
        return self.root / "work"

    @property
    def lights(self) -> Path:
        """Maps at their working size."""
        return self.work / "lights"

    @property
    def description(self) -> Path:
        """What was asked for."""
        return self.root / "dataset.json"

    @property
    def index(self) -> Path:
        """One row for each sample."""
        return self.root / "index.parquet"

    @property
    def failures(self) -> Path:
        """Attempts that gave no sample."""
        return self.root / "failures.jsonl"

    def complete_shards(self) -> list[Path]:
        """The shards that have their record, training first."""
        found = [path for path in self.shards.glob("*.tar") if path.with_suffix(".json").exists()]
        return sorted(found, key=lambda path: (_split_order(path), path.name))


def _split_order(path: Path) -> int:
    split = path.name.rpartition("-")[0]
    return SPLITS.index(split) if split in SPLITS else len(SPLITS)


@dataclass(frozen=True, slots=True, kw_only=True)
class ShardPlan:
    """One shard to be.

    Attributes:
        name: "train-00000".
        indices: The numbers of its samples, ascending; all of one split.
    """

    name: str
    indices: tuple[int, ...]


def plan_shards(
    split_of: Callable[[int], str], count: int, shard_samples: int
) -> tuple[ShardPlan, ...]:
    """Which samples go into which shard.

    Each split's samples, in the order of their numbers, fill shard after shard. So a larger
    `count` keeps every full shard as it is, and only the last of each split grows.

    Args:
        split_of: Index -> split.
        count: How many samples there are.
        shard_samples: How many go into a shard.

    Raises:
        UsageError: If there is nothing to do.
    """
    if count < 1 or shard_samples < 1:
        raise UsageError(
            f"A dataset has samples, and so have its shards: not --count {count} and "
            f"--shard-samples {shard_samples}."
        )
    of_split: dict[str, list[int]] = defaultdict(list)
    for index in range(count):
        of_split[split_of(index)].append(index)
    return tuple(
        ShardPlan(
            name=f"{split}-{number:05d}", indices=tuple(indices[start : start + shard_samples])
        )
        for split, indices in sorted(of_split.items(), key=lambda item: SPLITS.index(item[0]))
        for number, start in enumerate(range(0, len(indices), shard_samples))
    )

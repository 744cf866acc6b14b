"""How large a dataset would be and how long it would take, from a few samples made now."""

import shutil
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from panokit.dataset.production.attempts import SampleEvent, make_with_attempts
from panokit.dataset.production.maker import SampleMaker
from panokit.dataset.production.produce import choose_shard_samples, wanted_count
from panokit.dataset.production.settings import ProductionSettings
from panokit.dataset.storage.layout import DatasetFolder, plan_shards
from panokit.dataset.storage.shards import tar_bytes
from panokit.engine import available_cores, reports_to
from panokit.errors import ItemError

_MEASURED = 4
# Start of a worker: Python, the renderer, its first kernels.
_START_S = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """What a run would give, and need.

    Attributes:
        splits: Split -> samples.
        shards: How many there would be.
        measured: How many samples the figures are from.
        seconds_per_sample: On one core, attempts that are rejected included.
        bytes_per_sample: In a shard.
        workers: Processes.
        rejected: Reason -> attempts, among those measured.
        seconds: For all samples.
        bytes: For all samples.
        free_bytes: On the disk.
    """

    splits: Mapping[str, int]
    shards: int
    measured: int
    seconds_per_sample: float
    bytes_per_sample: float
    workers: int
    rejected: Mapping[str, int]
    seconds: float
    bytes: float
    free_bytes: int

    @property
    def fits(self) -> bool:
        """Whether the disk has room for it, with a tenth to spare."""
        return 1.1 * self.bytes < self.free_bytes


def estimate_dataset(maker: SampleMaker, out: Path, production: ProductionSettings) -> Estimate:
    """Make a few samples in this process, write nothing, and work out the rest.

    Args:
        maker: Makes the samples.
        out: Where the dataset would be.
        production: How it would be made.

    Raises:
        ItemError: If none of the first samples can be made.
    """
    out = Path(out)
    count, shard_samples = wanted_count(production), production.shard_samples
    size = shard_samples or choose_shard_samples(DatasetFolder(out), count)
    shards = plan_shards(maker.split_of, count, size)
    splits: Counter[str] = Counter()
    for shard in shards:
        splits[shard.name.rpartition("-")[0]] += len(shard.indices)
    workers = production.workers or available_cores()
    seconds: list[float] = []
    sizes: list[int] = []
    rejected: Counter[str] = Counter()
    complaints: list[str] = []

    def hear(event: SampleEvent) -> None:
        if event.message:
            complaints.append(event.message)

    # The first one pays for starting up, and does not count.
    for index in range(min(count, _MEASURED + 1)):
        started = time.process_time()
        with reports_to(hear):
            made = make_with_attempts(maker, index, {})
        seconds.append(time.process_time() - started)
        rejected.update(made.rejected)
        if made.sample:
            sizes.append(len(tar_bytes(made.sample.key, made.sample.members)))
    if not sizes:
        raise ItemError(
            f"None of the first {len(seconds)} samples could be made: {complaints[-1]}",
            reason=next(iter(rejected), "unusable"),
        )
    each = sum(seconds[1:]) / len(seconds[1:]) if len(seconds) > 1 else seconds[0]
    bytes_each = sum(sizes) / len(sizes)
    return Estimate(
        splits=dict(splits),
        shards=len(shards),
        measured=len(seconds),
        seconds_per_sample=each,
        bytes_per_sample=bytes_each,
        workers=workers,
        rejected=dict(rejected),
        seconds=_START_S + each * count / workers,
        bytes=bytes_each * count,
        free_bytes=_free_bytes(out),
    )


def _free_bytes(out: Path) -> int:
    there = next(path for path in (out.absolute(), *out.absolute().parents) if path.exists())
    return shutil.disk_usage(there).free

"""Make a dataset: all its shards, or those that are not there yet, in several processes."""

import shutil
import time
from collections import Counter
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from panokit.console import Console
from panokit.dataset.cards.card import write_card
from panokit.dataset.production.description import check_and_write, describe, read_description
from panokit.dataset.production.losses import LossPolicy
from panokit.dataset.production.maker import SampleMaker
from panokit.dataset.production.progress import Progress
from panokit.dataset.production.settings import ProductionSettings
from panokit.dataset.production.shard_task import STAGE, ShardItem, ShardTask, shard_key
from panokit.dataset.production.spool import Spool
from panokit.dataset.sample import sample_key
from panokit.dataset.storage.index import index_shards, indexed_digest, shards_digest, write_index
from panokit.dataset.storage.layout import LOCK, DatasetFolder, plan_shards
from panokit.engine import Engine, make_engine
from panokit.errors import SettingsError
from panokit.io.files import read_json
from panokit.io.lock import only_process
from panokit.records import RunFolder, is_complete

MOST_SHARD_SAMPLES, _FEWEST_SHARD_SAMPLES = 250, 16
# So that a small dataset, too, keeps several workers busy.
_WANTED_SHARDS = 32
# Renderers that grow are replaced by fresh ones.
_SAMPLES_PER_WORKER = 500


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderResult:
    """What became of a dataset.

    Attributes:
        folder: Where it is.
        samples: How many samples it has now.
        missing: Key -> why there is no such sample.
        rejected: Reason -> how many attempts gave no sample, over the whole dataset.
        made: How many samples were made now.
        seconds: How long that took.
        cpu_s: Processor time of the samples that were made now.
        bytes: Of all shards.
    """

    folder: Path
    samples: int
    missing: Mapping[str, str] = field(default_factory=dict)
    rejected: Mapping[str, int] = field(default_factory=dict)
    made: int = 0
    seconds: float = 0.0
    cpu_s: float = 0.0
    bytes: int = 0


def render_dataset(
    maker: SampleMaker,
    out: Path,
    production: ProductionSettings,
    console: Console | None = None,
) -> RenderResult:
    """Make samples 0 to `production.count` - 1 as shards with an index and a card.

    What is there already is kept, so a run that was stopped, however that happened, goes on
    where it was; its shards are the same byte for byte.

    Args:
        maker: Makes the samples.
        out: The dataset's folder.
        production: How many samples, in how many processes.
        console: Says how it goes.

    Raises:
        SettingsError: If the folder holds a dataset that was made otherwise.
        UsageError: If another process is rendering into it.
        StorageError: If the disk is full or cannot be written.
        PanokitError: If one sample after the other fails.
    """
    folder = DatasetFolder(Path(out))
    console = console or Console(quiet=True)
    count = wanted_count(production)
    with only_process(folder.root, LOCK, "rendering into"):
        run = RunFolder(folder.root).create()
        run.remove_leftovers()
        shard_samples = production.shard_samples or choose_shard_samples(folder, count)
        wanted = describe(maker, count, shard_samples)
        check_and_write(folder, wanted)
        items = [
            ShardItem(
                path=folder.shards / f"{plan.name}.tar",
                key=shard_key(wanted["key"], plan.indices),
                indices=plan.indices,
            )
            for plan in plan_shards(maker.split_of, count, shard_samples)
        ]
        waiting = [item for item in items if not _is_done(item, production.retry_missing)]
        spool = Spool(folder.work / "samples", wanted["key"])
        _sort_out(spool, items, waiting)
        kept = spool.kept()
        started = time.monotonic()
        run.log("started", count=count, shards=len(items), waiting=len(waiting))
        left = sum(len(item.indices) for item in waiting) - len(kept)
        if left < count:
            console.note(f"{STAGE}: {count - left} of {count} samples are there already")
        with console.stage(STAGE, left, unit="samples") as tick:
            progress = Progress(failures=folder.failures, seed_of=maker.seed_of, tick=tick)
            task = ShardTask(maker=maker, spool=spool)
            with closing(_engine(production, shard_samples, progress, run, console)) as engine:
                for outcome in engine.run(task, waiting):
                    run.log("shard", shard=outcome.item)
        result = _result(folder, items, progress, time.monotonic() - started)
        run.log(
            "ended", made=result.made, seconds=round(result.seconds, 1),
            cpu_s=round(result.cpu_s, 1), rejected=dict(progress.rejected),
        )  # fmt: skip
        finish(folder)
        # Also the maps at their working size: of hundreds of probes they fill the disk.
        shutil.rmtree(folder.work, ignore_errors=True)
    return result


def finish(folder: DatasetFolder) -> None:
    """Write card and index of the shards that are complete, unless the index is theirs.

    The index comes last: if it is there, the card is.

    Raises:
        RecordError: If a shard is damaged.
        StorageError: If something cannot be read or written.
    """
    shards = folder.complete_shards()
    digest = shards_digest(shards)
    if folder.index.exists() and indexed_digest(folder.root) == digest:
        return
    table = index_shards(shards, digest)
    write_card(folder.root, table)
    write_index(table, folder.index)


def wanted_count(production: ProductionSettings) -> int:
    """How many samples there are to be.

    Raises:
        SettingsError: If nobody said.
    """
    if production.count is None:
        raise SettingsError("How many samples? Give --count N, or count in the settings' file.")
    return production.count


def choose_shard_samples(folder: DatasetFolder, count: int) -> int:
    """How many samples a shard holds: as in the folder already, or else by the count."""
    if folder.description.exists():
        return int(read_description(folder.root)["shard_samples"])
    return min(MOST_SHARD_SAMPLES, max(_FEWEST_SHARD_SAMPLES, count // _WANTED_SHARDS))


def _is_done(item: ShardItem, retry_missing: bool) -> bool:
    if not is_complete(item.path, item.key):
        return False
    return not (retry_missing and read_json(item.path.with_suffix(".json"))["missing"])


def _sort_out(spool: Spool, items: list[ShardItem], waiting: list[ShardItem]) -> None:
    """Keep of earlier work what the waiting shards need, and clear away the rest."""
    spool.sweep()
    needed = {sample_key(index) for item in waiting for index in item.indices}
    spool.drop(key for key in spool.kept() if key not in needed)
    for item in waiting:
        record_path = item.path.with_suffix(".json")
        if item.path.exists() and record_path.exists():
            record = read_json(record_path)
            if record.get("dataset") == spool.dataset_key and is_complete(item.path, record["key"]):
                spool.unpack(item.path, record)


def _engine(
    production: ProductionSettings,
    shard_samples: int,
    progress: Progress,
    run: RunFolder,
    console: Console,
) -> Engine:
    return make_engine(
        "serial" if production.workers == 0 else production.engine,
        production.workers,
        production.cluster,
        items_per_worker=max(1, _SAMPLES_PER_WORKER // shard_samples),
        silence_s=production.timeout_s,
        on_report=progress.hear,
        on_loss=LossPolicy(progress, run, console, production.timeout_s),
    )


def _result(
    folder: DatasetFolder, items: list[ShardItem], progress: Progress, seconds: float
) -> RenderResult:
    rejected: Counter[str] = Counter()
    missing: dict[str, Any] = {}
    samples = size = 0
    for item in items:
        record = read_json(item.path.with_suffix(".json"))
        for reasons in record["rejected"].values():
            rejected.update(reasons)
        missing |= record["missing"]
        samples += record["samples"]
        size += record["files"][item.path.name]["bytes"]
    return RenderResult(
        folder=folder.root, samples=samples, missing=missing, rejected=dict(rejected),
        made=progress.done, seconds=seconds, cpu_s=progress.cpu_s, bytes=size,
    )  # fmt: skip

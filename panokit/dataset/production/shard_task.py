"""The task of a worker: one shard, sample after sample, written at once at its end."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from panokit.dataset.production.attempts import make_with_attempts
from panokit.dataset.production.maker import SampleMaker
from panokit.dataset.production.spool import Finished, Spool
from panokit.dataset.sample import sample_key
from panokit.dataset.storage.shards import tar_bytes, write_shard
from panokit.errors import StorageError
from panokit.io.files import file_entry, write_json
from panokit.provenance import digest_of
from panokit.records import Receipt

STAGE = "dataset"
SCHEMA = "panokit.shard/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class ShardItem:
    """One shard to be made.

    Attributes:
        path: Of its tar file.
        key: What it is made from and with.
        indices: Of its samples, ascending.
        lost: (index, attempt) -> why: attempts that must not be tried again.
    """

    path: Path
    key: str
    indices: tuple[int, ...]
    lost: Mapping[tuple[int, int], str] = field(default_factory=dict)


def shard_key(dataset_key: str, indices: tuple[int, ...]) -> str:
    """The key of a shard: equal keys promise equal bytes."""
    return digest_of([SCHEMA, dataset_key, list(indices)])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShardTask:
    """Makes shards; safe to run twice and to be killed at any moment.

    Attributes:
        maker: Makes the samples.
        spool: Keeps finished samples until their shard is written.
    """

    maker: SampleMaker
    spool: Spool

    def __call__(self, item: ShardItem) -> Receipt:
        """Make what is missing of a shard, and write it.

        Raises:
            PanokitError: If something is wrong that is not one sample's fault.
        """
        rejected: dict[str, Mapping[str, int]] = {}
        missing: dict[str, str] = {}
        keys = [sample_key(index) for index in item.indices]
        for index in item.indices:
            # Only one sample at a time is in memory, here and in `_data`.
            sample = self.spool.get(sample_key(index)) or self._make(index, item)
            if sample.rejected:
                rejected[sample.key] = sample.rejected
            if sample.missing:
                missing[sample.key] = sample.missing
        record_path = item.path.with_suffix(".json")
        # An old record must not stand beside the new file, not even for a moment.
        record_path.unlink(missing_ok=True)
        write_shard(item.path, map(self._data, keys))
        record = {
            "schema": SCHEMA,
            "key": item.key,
            "dataset": self.spool.dataset_key,
            "samples": len(keys) - len(missing),
            "missing": missing,
            "rejected": rejected,
            "files": {item.path.name: file_entry(item.path)},
        }
        write_json(record_path, record)
        self.spool.drop(keys)
        return Receipt(item=item.path.stem, stage=STAGE, path=item.path, key=item.key)

    def _make(self, index: int, item: ShardItem) -> Finished:
        key = sample_key(index)
        made = make_with_attempts(self.maker, index, item.lost)
        data = tar_bytes(key, made.sample.members) if made.sample else b""
        finished = Finished(key=key, data=data, missing=made.missing, rejected=made.rejected)
        self.spool.put(finished)
        return finished

    def _data(self, key: str) -> bytes:
        finished = self.spool.get(key)
        if finished is None:
            raise StorageError(
                f"The sample {key} is no longer in {self.spool.folder}. Leave that folder alone "
                "while samples are rendered, and run the same command again."
            )
        return finished.data

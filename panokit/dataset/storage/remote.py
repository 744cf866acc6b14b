"""Random access to the samples of a dataset behind a URL: only the bytes asked for are read."""

import io
from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from panokit.dataset.storage.index import SCHEMA
from panokit.dataset.storage.read import DEFAULT_MEMBERS, StereoDataset
from panokit.errors import RecordError, UsageError
from panokit.io.remote import open_remote


class RemoteDataset(StereoDataset):
    """A `StereoDataset` whose shards are read by URL, a range of bytes at a time.

    Args:
        url: Of the published folder: "s3://bucket/stereo-10k".
        split: "train", "validation" or "test"; all of them if not given.
        members: What to read of each sample.

    Raises:
        StorageError: If there is no dataset there.
        RecordError: If its index is damaged or of another version.
        UsageError: If it has no such split or member.
        MissingExtraError: If the URL's kind needs a package that is not installed.
    """

    def __init__(
        self, url: str, split: str | None = None, *, members: Sequence[str] = DEFAULT_MEMBERS
    ) -> None:
        self.remote = open_remote(url)
        try:
            table = pq.read_table(io.BytesIO(self.remote.read("index.parquet")))
        except pa.ArrowException as error:
            raise RecordError(
                f"{url}/index.parquet is damaged ({error}). Publish it again.",
                reason="damaged-index",
            ) from error
        if (table.schema.metadata or {}).get(b"panokit.schema") != SCHEMA.encode():
            raise RecordError(
                f"{url} has no index of this version of panokit. Publish it again.",
                reason="other-schema",
            )
        super().__init__(Path(url), split, members=members, index=table)

    def read(self, number: int, name: str) -> bytes:
        """One member of a sample as it is in the shard; see `StereoDataset.read`."""
        offset, size = self._spans[name][number] if name in self._spans else (-1, 0)
        if offset < 0:
            raise UsageError(
                f"Sample {self.keys[number]} has no member {name!r}, only "
                f"{', '.join(self.names(number))}."
            )
        shard = f"shards/{self.shard_names[int(self._shard[number])]}"
        data = self.remote.read(shard, int(offset), int(offset + size))
        if len(data) != size:
            raise RecordError(
                f"{self.remote.url}/{shard} ends before {self.keys[number]}.{name}. Publish it "
                "again.",
                reason="damaged-shard",
            )
        return data

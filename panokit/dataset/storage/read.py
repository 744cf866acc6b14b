"""Random access to the samples of a dataset, without unpacking anything."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from panokit.dataset.sample import SPLITS
from panokit.dataset.storage.decode import decode_member
from panokit.dataset.storage.index import BYTES, OFFSET, member_names, read_index
from panokit.dataset.storage.layout import DatasetFolder
from panokit.errors import RecordError, UsageError
from panokit.io.files import storage_error

# Of the 1024 files that a process may have open on most systems.
_MOST_OPEN = 256
DEFAULT_MEMBERS = ("left.png", "right.png", "background.png", "env64.exr")


class StereoDataset:
    """The samples of one split, by number or by key.

    `dataset[i]` is a dictionary: the member's name without its ending -> array, and "key". Only
    the bytes that are asked for are read, by their place in the index. It can be pickled and
    used from any number of threads and processes: `torch.utils.data.DataLoader` takes it as it
    is.

    Args:
        folder: Of the dataset.
        split: "train", "validation" or "test"; all of them if not given.
        members: What to read of each sample, in `decode_member`'s form.
        index: Of the dataset, instead of that in its folder: of one that is not finished.

    Raises:
        StorageError: If there is no dataset there.
        UsageError: If it has no such split or member.
    """

    def __init__(
        self,
        folder: str | Path,
        split: str | None = None,
        *,
        members: Sequence[str] = DEFAULT_MEMBERS,
        index: pa.Table | None = None,
    ) -> None:
        self.folder = Path(folder)
        self.split = split
        self.members = tuple(members)
        if split is not None and split not in SPLITS:
            raise UsageError(f"There is no split {split!r}; choose from {', '.join(SPLITS)}.")
        table = read_index(self.folder) if index is None else index
        known = member_names(table)
        for name in self.members:
            if name not in known:
                raise UsageError(
                    f"The samples have no member {name!r}; choose from {', '.join(known)}."
                )
        if split is not None:
            table = table.filter(pc.equal(table.column("split"), split))
        self.keys: NDArray[np.str_] = np.array(table.column("key").to_pylist(), dtype="U9")
        shards = table.column("shard").combine_chunks().dictionary_encode()
        self.shard_names: tuple[str, ...] = tuple(shards.dictionary.to_pylist())
        self._shard = shards.indices.to_numpy(zero_copy_only=False).astype(np.int32)
        self._spans = {
            name: np.stack(
                [
                    table.column(prefix + name).fill_null(-1).to_numpy().astype(np.int64)
                    for prefix in (OFFSET, BYTES)
                ],
                axis=1,
            )
            for name in known
        }
        self._files: dict[int, int] = {}

    def __len__(self) -> int:
        return len(self.keys)

    def __getitem__(self, number: int) -> dict[str, Any]:
        files = {name: self.read(number, name) for name in self.members}
        sample: dict[str, Any] = {
            name.rpartition(".")[0]: decode_member(name, data) for name, data in files.items()
        }
        return sample | {"key": str(self.keys[number])}

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (self[number] for number in range(len(self)))

    def number_of(self, key: str) -> int:
        """The number of the sample with a key.

        Raises:
            UsageError: If this split has none such.
        """
        found = np.flatnonzero(self.keys == key)
        if len(found) != 1:
            raise UsageError(f"There is no sample {key!r} in {self.split or 'any split'}.")
        return int(found[0])

    @property
    def shard_sizes(self) -> list[int]:
        """How many samples each shard has, in order; for `ShardSampler`."""
        return np.bincount(self._shard, minlength=len(self.shard_names)).tolist()

    def names(self, number: int) -> tuple[str, ...]:
        """The members that one sample has."""
        return tuple(name for name, spans in self._spans.items() if spans[number, 0] >= 0)

    def read(self, number: int, name: str) -> bytes:
        """One member of a sample as it is in the shard.

        Raises:
            UsageError: If the sample has no such member.
            RecordError: If the shard ends before it does.
            StorageError: If the shard cannot be read.
        """
        offset, size = self._spans[name][number] if name in self._spans else (-1, 0)
        if offset < 0:
            raise UsageError(
                f"Sample {self.keys[number]} has no member {name!r}, only "
                f"{', '.join(self.names(number))}."
            )
        shard = int(self._shard[number])
        try:
            # No position is shared, so threads and processes do not get into each other's way.
            with self._open(shard) as descriptor:
                data = os.pread(descriptor, int(size), int(offset))
        except OSError as error:
            raise storage_error("read", self._path(shard), error) from error
        if len(data) != size:
            raise RecordError(
                f"{self._path(shard)} ends before {self.keys[number]}.{name}. Run "
                "`panokit dataset verify`.",
                reason="damaged-shard",
            )
        return data

    def decoded(self, number: int, name: str) -> Any:
        """One member of a sample as `decode_member` gives it; see `read`."""
        return decode_member(name, self.read(number, name))

    def meta(self, number: int) -> Mapping[str, Any]:
        """All that is known of a sample."""
        value: Mapping[str, Any] = self.decoded(number, "meta.json")
        return value

    def close(self) -> None:
        """Close the shards; they are opened again when needed."""
        for descriptor in self._files.values():
            os.close(descriptor)
        self._files.clear()

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_files": {}}

    def __del__(self) -> None:
        if hasattr(self, "_files"):
            self.close()

    def _path(self, shard: int) -> Path:
        return DatasetFolder(self.folder).shards / self.shard_names[shard]

    @contextmanager
    def _open(self, shard: int) -> Iterator[int]:
        """A file descriptor of a shard; of the first shards that are read it stays open."""
        if shard in self._files:
            yield self._files[shard]
            return
        descriptor = os.open(self._path(shard), os.O_RDONLY)
        if (
            len(self._files) < _MOST_OPEN
            and self._files.setdefault(shard, descriptor) == descriptor
        ):
            yield descriptor
            return
        try:
            yield descriptor
        finally:
            os.close(descriptor)

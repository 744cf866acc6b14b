"""One sample again, alone: to look at, or to find out whether it comes out the same."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from panokit.dataset.production.attempts import SampleEvent, make_with_attempts
from panokit.dataset.production.description import check_same, describe, read_description
from panokit.dataset.production.maker import SampleMaker
from panokit.dataset.sample import Sample, sample_key
from panokit.dataset.storage.index import index_shards
from panokit.dataset.storage.layout import DatasetFolder
from panokit.dataset.storage.read import StereoDataset
from panokit.engine import reports_to
from panokit.errors import ItemError
from panokit.io.files import write_bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class Repeated:
    """A sample that was made alone.

    Attributes:
        folder: Where its files are.
        attempt: Which attempt gave it.
        shard: The shard that has it too, or "".
        different: Members that are not the same there.
    """

    folder: Path
    attempt: int
    shard: str = ""
    different: tuple[str, ...] = ()


def render_one(maker: SampleMaker, out: Path, index: int) -> Repeated:
    """Make sample `index` as files in the folder OUT/KEY.

    Where OUT holds the dataset, the same attempt is made that is in its shard, and compared.

    Raises:
        SettingsError: If OUT holds a dataset that is made otherwise.
        ItemError: If no attempt gives a sample.
    """
    place = DatasetFolder(Path(out))
    key = sample_key(index)
    known, shard, attempt = _known(maker, place, key)
    sample = _make(maker, index) if attempt is None else maker.make(index, attempt)
    for name, data in sample.members.items():
        write_bytes(place.root / key / name, data)
    different = {
        name for name in {*known, *sample.members} if known.get(name) != sample.members.get(name)
    }
    return Repeated(
        folder=place.root / key,
        attempt=int(sample.meta.get("attempt", attempt or 0)),
        shard=shard,
        different=tuple(sorted(different)) if shard else (),
    )


def _known(
    maker: SampleMaker, place: DatasetFolder, key: str
) -> tuple[Mapping[str, bytes], str, int | None]:
    """The sample as a complete shard has it: its files, the shard and the attempt."""
    if not place.description.exists():
        return {}, "", None
    found = read_description(place.root)
    check_same(place.root, found, describe(maker, found["count"], found["shard_samples"]))
    split = maker.split_of(int(key))
    for shard in place.complete_shards():
        if not shard.name.startswith(f"{split}-"):
            continue
        dataset = StereoDataset(place.root, members=(), index=index_shards([shard]))
        if key in dataset.keys:
            number = dataset.number_of(key)
            files = {name: dataset.read(number, name) for name in dataset.names(number)}
            return files, shard.name, int(dataset.meta(number)["attempt"])
    return {}, "", None


def _make(maker: SampleMaker, index: int) -> Sample:
    told: list[SampleEvent] = []
    with reports_to(told.append):
        made = make_with_attempts(maker, index, {})
    if made.sample is None:
        last = next(event for event in reversed(told) if event.message)
        raise ItemError(
            f"Sample {index} cannot be made; its last attempt said: {last.message}",
            reason=last.reason,
        )
    return made.sample

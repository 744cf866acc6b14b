"""Libraries, datasets and models of a run to where others read them: a folder or a URL.

What can be done there: publish, go on publishing, pull a copy that is checked, and read the samples
of a dataset directly (`panokit.dataset.storage.remote`). Runs, and libraries that are added to, lie
on this machine's disk: their writes depend on renaming, which object stores do not have.
"""

from collections.abc import Mapping
from pathlib import Path

from panokit.console import Console
from panokit.dataset.cards.card import FILES as CARD_FILES
from panokit.dataset.production.description import SCHEMA as DATASET
from panokit.dataset.storage.layout import DatasetFolder
from panokit.errors import UsageError
from panokit.io.files import read_json
from panokit.io.remote import open_remote, publish_files, pull_files
from panokit.pipeline.batch import BatchResult
from panokit.probes.library import SHELF_NAME
from panokit.records import RunFolder

_MODEL = "model.toml"


def publish_run(
    run: RunFolder, library: Path, url: str, batches: Mapping[str, BatchResult], console: Console
) -> int:
    """Publish what a run made: URL/library, and URL/NAME for each dataset and model.

    Returns:
        How many files were sent now.
    """
    folders = {"library": library} if (library / SHELF_NAME).is_dir() else {}
    for stage in ("dataset", "train"):
        if stage in batches:
            folders |= {r.path.name: r.path for r in batches[stage].receipts}
    return sum(
        publish(folder, f"{url.rstrip('/')}/{name}", console) for name, folder in folders.items()
    )


def publish(folder: Path, url: str, console: Console) -> int:
    """Publish a probe library, a dataset or a model, or go on where an earlier attempt stopped.

    Args:
        folder: Of it.
        url: Where to: "s3://bucket/library", or a path.
        console: Shows progress.

    Returns:
        How many files were sent now.

    Raises:
        UsageError: If the folder holds none of these.
        StorageError: If something cannot be read or written.
    """
    names = published_names(folder)
    with console.stage("publish", len(names), unit="files") as tick:
        return publish_files(folder, names, open_remote(url), tick)


def pull(url: str, folder: Path, console: Console) -> int:
    """Copy what was published to this machine, and check it; how many files came.

    A library's index is made when it is opened.

    Raises:
        StorageError: If nothing was published there.
        RecordError: If a file is not what was published.
    """
    remote = open_remote(url)
    with console.stage("pull", len(remote.listed()), unit="files") as tick:
        return pull_files(remote, folder, tick)


def published_names(folder: Path) -> list[str]:
    """The files of a library, dataset or model that are published, records after what they tell.

    Raises:
        UsageError: If the folder holds none of these.
    """
    if (folder / SHELF_NAME).is_dir():
        found = [
            path
            for probe in sorted((folder / SHELF_NAME).iterdir())
            if (probe / "probe.json").is_file()
            for path in sorted(probe.iterdir(), key=lambda p: (p.suffix == ".json", p.name))
        ]
    elif DatasetFolder(folder).description.is_file():
        dataset = DatasetFolder(folder)
        if read_json(dataset.description).get("schema") != DATASET:
            raise UsageError(f"{folder} is no dataset of this version of panokit.")
        shards = dataset.complete_shards()
        cards = [folder / name for name in CARD_FILES]
        found = [path for shard in shards for path in (shard, shard.with_suffix(".json"))]
        found += [path for path in (*cards, dataset.description, dataset.index) if path.is_file()]
    elif (folder / _MODEL).is_file():
        found = sorted(
            (p for p in folder.iterdir() if p.is_file()), key=lambda p: (p.name == _MODEL, p.name)
        )
    else:
        raise UsageError(f"{folder} holds no probe library, no dataset and no model to publish.")
    return [path.relative_to(folder).as_posix() for path in found]

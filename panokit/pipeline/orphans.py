"""What lies in a run's folder and belongs to nothing that the run has now."""

import shutil
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from panokit.errors import RecordError, UsageError
from panokit.io.files import read_json, storage_error
from panokit.io.lock import only_process
from panokit.io.pictures import record_path
from panokit.ledger import Ledger
from panokit.pipeline.fetching import recorded_captures
from panokit.pipeline.once import record_of
from panokit.pipeline.runner import LOCK
from panokit.pipeline.settings import PipelineSettings
from panokit.records import RunFolder

_PICTURES = (".jpg", ".exr")
_ENDINGS = (".mask.png", ".compare", ".json", *_PICTURES)


@dataclass(frozen=True, slots=True, kw_only=True)
class Orphan:
    """A file or folder that nothing needs.

    Attributes:
        path: Of it.
        why: In a few words.
        bytes: Of it and all in it.
    """

    path: Path
    why: str
    bytes: int


def find_orphans(settings: PipelineSettings) -> list[Orphan]:
    """What a run's folder has besides what its last finished walk through the stages named.

    The library is left alone: other runs may add to it.

    Raises:
        UsageError: If fetching has not finished: nobody can tell then what belongs to the run.
    """
    run = RunFolder(settings.folder())
    captures = recorded_captures(run)
    if captures is None:
        raise UsageError(
            f"Fetching into {run.root} has not finished, so nobody can tell what belongs to it. "
            "Run the pipeline first, at least with --stop-after fetch."
        )
    wanted = set(captures)
    found = [*_leftovers(run), *_captures(run, wanted)]
    for folder in (run.panoramas, run.filled, run.probes):
        found += _pictures(folder, wanted)
    for folder in (run.models, run.references):
        found += _made(folder, set(_keys(run)))
    return found


def remove_orphans(settings: PipelineSettings) -> list[Orphan]:
    """Delete what `find_orphans` finds, and tell what it was.

    Raises:
        UsageError: If a process runs the pipeline, or see `find_orphans`.
        StorageError: If something cannot be deleted.
    """
    run = RunFolder(settings.folder())
    if not run.root.is_dir():
        raise UsageError(f"There is no run in {run.root}.")
    with only_process(run.root, LOCK, "running a pipeline in"):
        found = find_orphans(settings)
        for orphan in found:
            try:
                if orphan.path.is_dir() and not orphan.path.is_symlink():
                    shutil.rmtree(orphan.path)
                else:
                    orphan.path.unlink(missing_ok=True)
            except OSError as error:
                raise storage_error("delete", orphan.path, error) from error
    return found


def _leftovers(run: RunFolder) -> Iterator[Orphan]:
    for path in sorted(run.root.rglob("*.part")):
        if path.is_file():
            yield _orphan(path, "half written")


def _captures(run: RunFolder, wanted: set[str]) -> Iterator[Orphan]:
    for folder in _inside(run.captures):
        if folder.is_dir() and folder.name not in wanted:
            yield _orphan(folder, "of no area")


def _pictures(folder: Path, wanted: set[str]) -> Iterator[Orphan]:
    """Pictures, records and comparisons, by the item that their name begins with."""
    for path in _inside(folder):
        ending = next((e for e in _ENDINGS if path.name.endswith(e)), "")
        if not ending:
            continue  # half written, or somebody's own
        if path.name.removesuffix(ending) not in wanted:
            yield _orphan(path, "of no capture")
        elif path.suffix in _PICTURES and not record_path(path).exists():
            yield _orphan(path, "without a record")


def _made(folder: Path, keys: set[str]) -> Iterator[Orphan]:
    """What earlier settings made: folders with a record whose key is none of the last run's."""
    for record in _inside(folder):
        if record.suffix != ".json" or not record.is_file():
            continue
        try:
            key = read_json(record)["key"]
        except (RecordError, KeyError, TypeError):
            continue
        if key in keys:
            continue
        made = record.with_suffix("")
        for path in (
            made,
            made.with_name(f"{made.name}-work"),
            made.with_name(f"{made.name}-lights"),
            record_of(made),
        ):
            if path.exists():
                yield _orphan(path, "of other settings")


def _keys(run: RunFolder) -> Iterator[str]:
    return (key for _, _, key, _ in Ledger(run.ledger).content())


def _inside(folder: Path) -> Iterable[Path]:
    return sorted(folder.iterdir()) if folder.is_dir() else ()


def _orphan(path: Path, why: str) -> Orphan:
    files = [path] if not path.is_dir() else [p for p in path.rglob("*") if p.is_file()]
    return Orphan(path=path, why=why, bytes=sum(file.lstat().st_size for file in files))

"""One run at a time in a folder, and a clean folder to begin with."""

import re
import shutil
from contextlib import AbstractContextManager
from pathlib import Path

from panokit.io.captures import RECORD
from panokit.io.files import storage_error
from panokit.io.lock import only_process

LOCK = ".fetch.lock"
# What fetch itself writes before the record; anything else in a folder is somebody's own.
_OURS = re.compile(r"^(tiles/|views/)?(\.[^/]+\.part|\d+(_\d+)?\.\w+|image\.\w+)$")


def only_run(out: Path) -> AbstractContextManager[None]:
    """Hold the folder of a run; see `panokit.io.lock.only_process`."""
    return only_process(out, LOCK, "fetching into")


def remove_unfinished(out: Path) -> int:
    """Delete what a killed run left: captures without a record, and temporary files.

    Only for who holds the folder: what is unfinished may be under way in another process.

    Returns:
        How many captures there were.

    Raises:
        StorageError: If something cannot be deleted.
    """
    captures = out / "captures"
    removed = 0
    for folder in captures.iterdir() if captures.is_dir() else ():
        if not folder.is_dir() or (folder / RECORD).exists():
            continue
        files = [path for path in folder.rglob("*") if not path.is_dir()]
        ours = all(_OURS.match(path.relative_to(folder).as_posix()) for path in files)
        if ours or _is_part(folder):
            _delete(folder)
            removed += 1
    for part in (*out.glob(".*.part"), *captures.glob("*/.*.part")):
        _delete(part)
    return removed


def _is_part(path: Path) -> bool:
    return path.name.startswith(".") and path.suffix == ".part"


def _delete(path: Path) -> None:
    try:
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink()
    except OSError as error:
        raise storage_error("delete", path, error) from error

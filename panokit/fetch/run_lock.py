"""One run at a time in a folder, and a clean folder to begin with."""

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from panokit.errors import UsageError
from panokit.io.captures import RECORD
from panokit.io.files import storage_error

LOCK = ".fetch.lock"
# What fetch itself writes before the record; anything else in a folder is somebody's own.
_OURS = re.compile(r"^(tiles/|views/)?(\.[^/]+\.part|\d+(_\d+)?\.\w+|image\.\w+)$")


@contextmanager
def only_run(out: Path) -> Iterator[None]:
    """Hold the folder of a run; a lock ends with its process, however that ends.

    Raises:
        UsageError: If another process fetches into it: a cron job that overtakes itself.
        StorageError: If the folder cannot be written.
    """
    try:
        import fcntl
    except ImportError:  # not on this system
        yield
        return
    path = out / LOCK
    while True:
        try:
            out.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(path, os.O_CREAT | os.O_RDWR, 0o666)
        except OSError as error:
            raise storage_error("write", path, error) from error
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            raise UsageError(
                f"Another process is fetching into {out}. Wait for it, or choose another --out."
            ) from None
        except OSError:
            pass  # a file system without locks
        # Its last holder may have removed the file between our opening and locking it.
        with suppress(FileNotFoundError):
            if path.stat().st_ino == os.fstat(descriptor).st_ino:
                break
        os.close(descriptor)
    try:
        yield
    finally:
        with suppress(OSError):
            path.unlink()
        os.close(descriptor)


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

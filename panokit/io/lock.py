"""One process at a time in a folder."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from panokit.errors import UsageError
from panokit.io.files import storage_error


@contextmanager
def only_process(folder: Path, name: str, doing: str) -> Iterator[None]:
    """Hold a folder; the lock ends with its process, however that ends.

    Args:
        folder: It is made if it is not there.
        name: Of the lock's file, which is removed at the end.
        doing: What only one process may do there: "rendering into".

    Raises:
        UsageError: If another process holds it: a cron job that overtakes itself.
        StorageError: If the folder cannot be written.
    """
    try:
        import fcntl
    except ImportError:  # not on this system
        yield
        return
    path = folder / name
    while True:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(path, os.O_CREAT | os.O_RDWR, 0o666)
        except OSError as error:
            raise storage_error("write", path, error) from error
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            raise UsageError(
                f"Another process is {doing} {folder}. Wait for it, or choose another --out."
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

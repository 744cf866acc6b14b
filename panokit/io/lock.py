"""One process at a time in a folder."""

import os
import socket
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
                f"{_named(path)} is {doing} {folder}. Wait for it, or choose another --out."
            ) from None
        except OSError:
            pass  # a file system without locks
        # Its last holder may have removed the file between our opening and locking it.
        with suppress(FileNotFoundError):
            if path.stat().st_ino == os.fstat(descriptor).st_ino:
                break
        os.close(descriptor)
    _introduce(descriptor)
    try:
        yield
    finally:
        with suppress(OSError):
            path.unlink()
        os.close(descriptor)


def holder_of(folder: Path, name: str) -> str:
    """Who holds a folder, as "process 12 on host-a"; "" if nobody does.

    A process of this machine that is gone holds nothing; of other machines nobody can tell.
    """
    try:
        told = (folder / name).read_text(encoding="utf-8")
        pid, host = told.split()
    except (OSError, ValueError):
        return ""
    if host == socket.gethostname():
        try:
            os.kill(int(pid), 0)
        except PermissionError:
            pass  # it is there, and somebody else's
        except (OSError, ValueError):
            return ""
    return f"process {pid} on {host}"


def _introduce(descriptor: int) -> None:
    """Write into the lock's file who holds it; the lock itself does not depend on that."""
    with suppress(OSError):
        os.ftruncate(descriptor, 0)
        os.write(descriptor, f"{os.getpid()} {socket.gethostname()}\n".encode())


def _named(path: Path) -> str:
    holder = holder_of(path.parent, path.name)
    return f"Another process ({holder.removeprefix('process ')})" if holder else "Another process"

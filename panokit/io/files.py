"""Files that are either whole or not there: temporary file, fsync, atomic rename; and digests."""

import errno
import hashlib
import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from panokit.errors import RecordError, StorageError

_REMEDIES = {
    errno.ENOSPC: "The disk is full: free some space and run the same command again.",
    errno.EDQUOT: "Your disk quota is used up: free some space and run the same command again.",
    errno.EACCES: "Check the permissions of the file and of its folder.",
    errno.EPERM: "Check the permissions of the file and of its folder.",
    errno.EROFS: "The disk is read-only: choose another folder with --out.",
    errno.ENOENT: "Check the path.",
    errno.ENOTDIR: "A part of the path is a file, not a folder: choose another path.",
    errno.EISDIR: "The path is a folder where a file was meant.",
    errno.ENAMETOOLONG: "The name is too long: choose a shorter one.",
}


def storage_error(action: str, path: Path, error: OSError) -> StorageError:
    """The error to raise when the operating system refuses to do `action` to `path`."""
    remedy = _REMEDIES.get(error.errno or 0, "Check the disk and the path.")
    return StorageError(f"Cannot {action} {path}: {error.strerror or error}. {remedy}")


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """A temporary file to fill, which takes the place of `path` when the block ends well.

    Until then, and if the block fails or the process is killed, `path` stays as it was.
    The temporary file ends in `.part` and lies in the same folder.

    Raises:
        StorageError: If the disk is full or the folder cannot be written.
    """
    path = Path(path)
    part: Path | None = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
        os.close(handle)
        part = Path(name)
        yield part
        _sync(part)
        part.chmod(0o666 & ~_UMASK)
        part.replace(path)
        part = None
        _sync(path.parent)
    except StorageError:
        raise
    except OSError as error:
        raise storage_error("write", path, error) from error
    finally:
        if part is not None:
            with suppress(OSError):
                part.unlink()


def write_bytes(path: Path, data: bytes) -> None:
    """Write a whole file atomically; see `atomic_write`."""
    with atomic_write(path) as part:
        part.write_bytes(data)


def write_synced(path: Path, data: bytes) -> None:
    """Write a file of a folder that nobody reads yet: on the disk when this returns, not atomic.

    Raises:
        StorageError: If the disk is full or the folder cannot be written.
    """
    try:
        with path.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise storage_error("write", path, error) from error


def publish_folder(part: Path, path: Path) -> None:
    """Give a finished folder its name; until then, it is not there. Its files must be synced.

    Raises:
        StorageError: If there is one of that name already, or the disk fails.
    """
    try:
        for folder in (part, *(child for child in part.iterdir() if child.is_dir())):
            _sync(folder)
        part.rename(path)
        _sync(path.parent)
    except OSError as error:
        raise storage_error("write", path, error) from error


def write_json(path: Path, value: Any) -> None:
    """Write JSON for people and programs: indented, sorted, the same bytes for equal values."""
    text = json.dumps(value, indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False)
    write_bytes(path, (text + "\n").encode())


def read_bytes(path: Path) -> bytes:
    """The content of a file.

    Raises:
        StorageError: If it cannot be read.
    """
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise storage_error("read", Path(path), error) from error


def read_json(path: Path) -> Any:
    """The value in a JSON file.

    Raises:
        RecordError: If it is missing or damaged.
    """
    try:
        return json.loads(Path(path).read_bytes())
    except FileNotFoundError as error:
        raise RecordError(f"There is no record {path}.", reason="no-record") from error
    except (ValueError, UnicodeDecodeError) as error:
        raise RecordError(
            f"The record {path} is damaged ({error}). Delete it and run the stage again.",
            reason="damaged-record",
        ) from error
    except OSError as error:
        raise storage_error("read", Path(path), error) from error


def sha256_of_bytes(data: bytes | memoryview) -> str:
    """The SHA-256 of some bytes, in hex."""
    return hashlib.sha256(data).hexdigest()


def sha256_of_file(path: Path) -> str:
    """The SHA-256 of a file's content, in hex, without reading it whole into memory."""
    try:
        with Path(path).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise storage_error("read", Path(path), error) from error


def file_entry(path: Path) -> dict[str, Any]:
    """What a record says of a file: its size and digest."""
    return {"bytes": Path(path).stat().st_size, "sha256": sha256_of_file(path)}


def _current_umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


# Read once: asking means setting, which another thread could see.
_UMASK = _current_umask()


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)

"""Folders that are reached by a URL, through fsspec: memory://, file://, s3:// and others.

A published folder has a list of its files with their digests, written last; so a copy that was
interrupted is gone on with, and what is read is what was published.
"""

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fsspec

from panokit.errors import MissingExtraError, RecordError, StorageError, UsageError
from panokit.io.files import atomic_write, sha256_of_bytes, sha256_of_file, storage_error

LIST = "panokit-files.json"
SCHEMA = "panokit.files/1"
# Options for the protocol of a URL, as JSON: {"endpoint_url": "http://127.0.0.1:9000"}.
OPTIONS_VARIABLE = "PANOKIT_STORAGE_OPTIONS"
_EXTRAS = {"s3": ("s3fs", "s3"), "s3a": ("s3fs", "s3")}


def is_url(text: str) -> bool:
    """Whether a text is the URL of a folder, not its path on this machine."""
    return "://" in text


@dataclass(frozen=True, slots=True)
class RemoteFolder:
    """A folder behind a URL.

    Attributes:
        url: Of it, without a slash at its end.
        files: The file system that fsspec has for it.
        root: Its path there.
    """

    url: str
    files: Any
    root: str

    def read(self, name: str, start: int | None = None, end: int | None = None) -> bytes:
        """The bytes of a file, or of a part of it.

        Raises:
            StorageError: If it cannot be read.
        """
        try:
            return bytes(self.files.cat_file(f"{self.root}/{name}", start=start, end=end))
        except OSError as error:
            raise storage_error("read", Path(f"{self.url}/{name}"), error) from error

    def write(self, name: str, source: Path) -> None:
        """Copy a file there.

        Raises:
            StorageError: If it cannot be written.
        """
        path = f"{self.root}/{name}"
        try:
            self.files.makedirs(path.rpartition("/")[0], exist_ok=True)
            self.files.put_file(str(source), path)
        except OSError as error:
            raise storage_error("write", Path(f"{self.url}/{name}"), error) from error

    def listed(self) -> dict[str, dict[str, Any]]:
        """Name -> size and digest of the files that were published there; empty if none were.

        Raises:
            RecordError: If the list is damaged.
        """
        try:
            if not self.files.exists(f"{self.root}/{LIST}"):
                return {}
        except OSError as error:
            raise storage_error("read", Path(self.url), error) from error
        try:
            record = json.loads(self.read(LIST))
            if record["schema"] != SCHEMA:
                raise KeyError(record["schema"])
            return dict(record["files"])
        except (ValueError, KeyError, TypeError) as error:
            raise RecordError(
                f"{self.url}/{LIST} is no list of files. Delete it and publish again."
            ) from error


def open_remote(url: str) -> RemoteFolder:
    """The folder behind a URL; it need not be there yet.

    Raises:
        UsageError: If nobody knows what kind of URL it is.
        MissingExtraError: If its kind needs a package that is not installed.
    """
    protocol = url.partition("://")[0]
    options = _options()
    try:
        files, root = fsspec.core.url_to_fs(url, **options)
    except ImportError as error:
        package, extra = _EXTRAS.get(protocol, (protocol, ""))
        if extra:
            raise MissingExtraError(package, extra, f"{protocol}://") from error
        raise UsageError(f"{url}: fsspec needs a package for {protocol}://: {error}.") from error
    except (ValueError, TypeError) as error:
        raise UsageError(f"{url} is no URL that fsspec knows: {error}.") from error
    return RemoteFolder(url=url.rstrip("/"), files=files, root=str(root).rstrip("/"))


def publish_files(
    folder: Path,
    names: Sequence[str],
    remote: RemoteFolder,
    tick: Callable[[], object] = lambda: None,
) -> int:
    """Copy files of a folder to a remote one; those that are there already are not sent again.

    Args:
        folder: On this machine.
        names: The files, with / between folders, in the order in which they are sent.
        remote: Where to.
        tick: Called after each.

    Returns:
        How many were sent.

    Raises:
        StorageError: If something cannot be read or written.
    """
    known = remote.listed()
    told: dict[str, dict[str, Any]] = {}
    sent = 0
    for name in names:
        source = folder / name
        entry = {"bytes": source.stat().st_size, "sha256": sha256_of_file(source)}
        if known.get(name) != entry:
            remote.write(name, source)
            sent += 1
        told[name] = entry
        tick()
    if told != known:
        text = json.dumps({"schema": SCHEMA, "files": told}, indent=1, sort_keys=True)
        _write_text(remote, text)
    return sent


def pull_files(
    remote: RemoteFolder, folder: Path, tick: Callable[[], object] = lambda: None
) -> int:
    """Copy what was published to a folder on this machine, and check it.

    Returns:
        How many files came; those that are there with the same digest do not come again.

    Raises:
        StorageError: If nothing was published there, or something cannot be read or written.
        RecordError: If a file is not what was published.
    """
    files = remote.listed()
    if not files:
        raise StorageError(
            f"Nothing was published in {remote.url}: there is no {LIST}. Check the URL."
        )
    came = 0
    for name, entry in files.items():
        target = _inside(folder, name)
        if not _is_same(target, entry):
            data = remote.read(name)
            if sha256_of_bytes(data) != entry["sha256"]:
                raise RecordError(
                    f"{remote.url}/{name} is not what was published. Publish it again.",
                    reason="changed-on-disk",
                )
            with atomic_write(target) as part:
                part.write_bytes(data)
            came += 1
        tick()
    return came


def _inside(folder: Path, name: str) -> Path:
    target = Path(os.path.normpath(folder / name))
    if not target.is_relative_to(os.path.normpath(folder)):
        raise RecordError(f"A published file is called {name!r}, which leads out of its folder.")
    return target


def _is_same(path: Path, entry: Mapping[str, Any]) -> bool:
    return (
        path.is_file()
        and path.stat().st_size == entry["bytes"]
        and sha256_of_file(path) == entry["sha256"]
    )


def _write_text(remote: RemoteFolder, text: str) -> None:
    try:
        remote.files.pipe_file(f"{remote.root}/{LIST}", (text + "\n").encode())
    except OSError as error:
        raise storage_error("write", Path(f"{remote.url}/{LIST}"), error) from error


def _options() -> dict[str, Any]:
    text = os.environ.get(OPTIONS_VARIABLE, "")
    try:
        value = json.loads(text) if text else {}
    except ValueError as error:
        raise UsageError(f"{OPTIONS_VARIABLE} is no JSON: {error}.") from error
    if not isinstance(value, dict):
        raise UsageError(f"{OPTIONS_VARIABLE} is to be a JSON object.")
    return value

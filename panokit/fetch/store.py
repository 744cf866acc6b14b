"""One picture found -> its files on disk, and its record last."""

import shutil
from collections.abc import Mapping
from concurrent.futures import Executor, Future, wait
from dataclasses import replace
from pathlib import Path

from panokit.errors import ItemError, RecordError, StorageError
from panokit.fetch.provider import Found, Provider
from panokit.io.captures import RECORD, StoredCapture, read_capture, write_capture
from panokit.io.files import sha256_of_bytes, write_bytes


class Download:
    """The files of one picture on their way to the disk.

    Args:
        found: The picture.
        folder: Where it goes; what an interrupted run left there is removed.
        provider: Where it comes from.
        executor: Fetches the files.
    """

    def __init__(self, found: Found, folder: Path, provider: Provider, executor: Executor) -> None:
        self.found = found
        self._folder = folder
        self.discard()
        self._files: dict[str, Future[str]] = {
            name: executor.submit(_fetch_file, provider, found, name, folder)
            for name in found.files
        }

    @property
    def outstanding(self) -> int:
        """How many files are not there yet."""
        return sum(not future.done() for future in self._files.values())

    def finish(self, *, allow_missing: bool) -> StoredCapture:
        """Wait for the files and write the record. After an error, `cancel` cleans up.

        Args:
            allow_missing: Record tiles that cannot be had as missing, instead of failing.

        Raises:
            ItemError: If the picture cannot be had; a tile of it has the reason
                "missing-tile".
            PanokitError: What else stopped the transfer.
        """
        digests: dict[str, str] = {}
        for name, future in self._files.items():
            try:
                digests[name] = future.result()
            except ItemError as error:
                if self.found.grid is None:
                    raise
                if not allow_missing:
                    raise self._missing_tile(name, error) from error
        if not digests:
            raise ItemError(
                f"{self.found.capture.key}: not one tile can be had.", reason="missing-tile"
            )
        return self._write_record(digests)

    def cancel(self) -> None:
        """Stop, wait for what is under way, and leave nothing on disk."""
        for future in self._files.values():
            future.cancel()
        wait(self._files.values())
        self.discard()

    def discard(self) -> None:
        """Remove the folder and what is in it."""
        try:
            shutil.rmtree(self._folder)
        except FileNotFoundError:
            pass
        except OSError as error:
            raise StorageError(
                f"Cannot remove {self._folder}: {error.strerror}. Check its permissions."
            ) from error

    def _write_record(self, digests: Mapping[str, str]) -> StoredCapture:
        grid = self.found.grid
        if grid is not None:
            have = set(digests)
            cells = zip(grid.cells(), self.found.files, strict=True)
            grid = replace(grid, missing=tuple(cell for cell, name in cells if name not in have))
        stored = StoredCapture(
            folder=self._folder, capture=self.found.capture, grid=grid, files=digests
        )
        write_capture(stored, raw=self.found.raw)
        return stored

    def _missing_tile(self, name: str, error: ItemError) -> ItemError:
        return ItemError(
            f"{self.found.capture.key}: {name} cannot be had. {error} To take such panoramas "
            "with a hole, allow missing tiles.",
            reason="missing-tile",
            values={"tile": name, "cause": error.reason},
        )


def stored_captures(captures: Path) -> dict[str, StoredCapture]:
    """The complete captures in a folder of capture folders, by key; damaged ones do not count."""
    found = {}
    for record in sorted(captures.glob(f"*/{RECORD}")):
        try:
            stored = read_capture(record.parent)
        except RecordError:
            continue  # damaged: it will be fetched again
        found[stored.capture.key] = stored
    return found


def _fetch_file(provider: Provider, found: Found, name: str, folder: Path) -> str:
    data = provider.read(found, name)
    write_bytes(folder / name, data)
    return sha256_of_bytes(data)

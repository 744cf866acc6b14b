"""One picture found -> its files on disk, and its record last."""

import shutil
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor, Future, wait
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError, ItemError, RecordError
from panokit.fetch import guard
from panokit.fetch.provider import Found, Provider
from panokit.io.captures import (
    RECORD,
    StoredCapture,
    cell_of_tile,
    read_capture,
    tile_name,
    write_capture,
)
from panokit.io.files import (
    publish_folder,
    read_bytes,
    sha256_of_bytes,
    storage_error,
    write_synced,
)

_BLACK_TILE = ImageError(
    "It is black, and what lies beside it is not. Fetch it again later.", reason="black-tile"
)


class Download:
    """The files of one picture on their way to the disk.

    Args:
        found: The picture.
        folder: Where it goes; what an interrupted run left there is removed.
        provider: Where it comes from.
        network: Fetches the files.
        disk: Writes them, for a disk that takes its time must not hold up the network.
        guarded: Whether to refuse what is black instead of a picture.
    """

    def __init__(
        self,
        found: Found,
        folder: Path,
        provider: Provider,
        network: Executor,
        disk: Executor,
        *,
        guarded: bool = True,
    ) -> None:
        self.found = found
        self._folder = folder
        # Files are written here, and nobody sees them before they are all there.
        self._part = folder.with_name(f".{folder.name}.part")
        self._provider = provider
        self._network = network
        self._disk = disk
        # Views are small parts of a picture: one may well be dark.
        self._guarded = guarded and not found.views
        self.discard()
        self._make_folders()
        self._files = {name: self._submit(name) for name in found.files}

    @property
    def outstanding(self) -> int:
        """How many files are not there yet."""
        return sum(not _is_there(future) for future in self._files.values())

    def finish(self, *, allow_missing: bool) -> StoredCapture:
        """Wait for the files and write the record. After an error, `cancel` cleans up.

        Args:
            allow_missing: Record tiles that cannot be had as missing, instead of failing.

        Raises:
            ItemError: If the picture cannot be had; a tile of it has the reason
                "missing-tile".
            PanokitError: What else stopped the transfer.
        """
        files: dict[str, _File] = {}
        for name in self._files:
            self._collect(name, files, allow_missing=allow_missing)
        for name in self._black_tiles(files):
            # Perhaps it was a hiccup; what is black twice is not there.
            del files[name]
            self._files[name] = self._submit(name)
            self._collect(name, files, allow_missing=allow_missing)
        for name in self._black_tiles(files):
            if not allow_missing:
                raise self._missing_tile(name, _BLACK_TILE)
            del files[name]
            (self._part / name).unlink(missing_ok=True)
        if not files:
            raise ItemError(
                f"{self.found.capture.key}: not one tile can be had.", reason="missing-tile"
            )
        self._check(files)
        return self._write_record({name: file.digest for name, file in files.items()})

    def cancel(self) -> None:
        """Stop, wait for what is under way, and leave nothing on disk that is not whole."""
        for future in self._files.values():
            future.cancel()
        wait(self._files.values())
        wait([file.written for file in _successes(self._files.values())])
        # An interrupt may come between the record and the return: then it is whole.
        if not (self._folder / RECORD).exists():
            self.discard()

    def discard(self) -> None:
        """Remove the folder and what is in it, finished or not."""
        for folder in (self._part, self._folder):
            try:
                shutil.rmtree(folder)
            except FileNotFoundError:
                pass
            except OSError as error:
                raise storage_error("delete", folder, error) from error

    def _make_folders(self) -> None:
        for parent in {(self._part / name).parent for name in self.found.files}:
            try:
                parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise storage_error("write", parent, error) from error

    def _submit(self, name: str) -> "Future[_File]":
        return self._network.submit(self._fetch_file, name)

    def _fetch_file(self, name: str) -> "_File":
        data = self._provider.read(self.found, name)
        glance = guard.glance(data) if self._is_suspect(name, data) else None
        written = self._disk.submit(write_synced, self._part / name, data)
        return _File(sha256_of_bytes(data), glance, written)

    def _is_suspect(self, name: str, data: bytes) -> bool:
        """Whether a file has to be looked at for black."""
        grid, cell = self.found.grid, cell_of_tile(name)
        if not self._guarded or grid is None or cell is None:
            return self._guarded
        return not guard.is_too_rich_for_black(data, grid, cell)

    def _collect(self, name: str, files: "dict[str, _File]", *, allow_missing: bool) -> None:
        try:
            file = self._files[name].result()
            file.written.result()
            files[name] = file
        except ItemError as error:
            if self.found.grid is None:
                raise
            if not allow_missing:
                raise self._missing_tile(name, error) from error

    def _glances(self, files: "Mapping[str, _File]") -> dict[guard.Cell, NDArray[np.uint8]]:
        cells = self.found.grid.cells() if self.found.grid else ()
        named = zip(cells, self.found.files, strict=True)
        seen = {cell: files[name].glance for cell, name in named if name in files}
        return {cell: glance for cell, glance in seen.items() if glance is not None}

    def _black_tiles(self, files: "dict[str, _File]") -> list[str]:
        grid = self.found.grid
        if grid is None or not self._guarded:
            return []
        if not any(guard.is_black(glance) for glance in self._glances(files).values()):
            return []
        for name, file in files.items():
            if file.glance is None:  # what lies beside black has to be known
                files[name] = replace(file, glance=guard.glance(read_bytes(self._part / name)))
        return [tile_name(*cell) for cell in sorted(guard.lost_cells(self._glances(files), grid))]

    def _check(self, files: "Mapping[str, _File]") -> None:
        """Refuse a frame with black bars; tiles that are missing are no bars."""
        if not self._guarded:
            return
        if self.found.grid is not None:
            frame = guard.lay_out(self._glances(files), self.found.grid)
            guard.check_frame(frame, self.found.capture.key)
        else:
            for file in files.values():
                if file.glance is not None:
                    guard.check_frame(file.glance, self.found.capture.key)

    def _write_record(self, digests: Mapping[str, str]) -> StoredCapture:
        grid = self.found.grid
        if grid is not None:
            have = set(digests)
            cells = zip(grid.cells(), self.found.files, strict=True)
            grid = replace(grid, missing=tuple(cell for cell, name in cells if name not in have))
        stored = StoredCapture(
            folder=self._folder,
            capture=self.found.capture,
            grid=grid,
            views=self.found.views,
            files=digests,
        )
        publish_folder(self._part, self._folder)
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


@dataclass(frozen=True, slots=True, eq=False)
class _File:
    """A file that came: its SHA-256, what it looks like from afar, and its way to the disk."""

    digest: str
    glance: NDArray[np.uint8] | None  # None where it cannot be black
    written: Future[None]


def _successes(files: Iterable[Future[_File]]) -> list[_File]:
    return [one.result() for one in files if not one.cancelled() and one.exception() is None]


def _is_there(file: Future[_File]) -> bool:
    """Whether nothing is to be waited for any more, be it a file or a failure."""
    return file.done() and all(one.written.done() for one in _successes([file]))

"""Files that a browser sends: safe names, and no more bytes than the settings allow."""

import re
import shutil
import unicodedata
from collections.abc import AsyncIterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from panokit.errors import StorageError, UsageError
from panokit.io.files import storage_error

PICTURES = (".jpg", ".jpeg", ".png", ".webp", ".tif", ".tiff")
VIDEOS = (".mp4", ".mov", ".m4v", ".avi", ".mkv", ".webm", ".mpg", ".mpeg")
_RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
_LONGEST_NAME = 100
_MEGABYTE = 1_000_000
# What must stay free on the disk, whatever is sent.
_SPARE_BYTES = 500 * _MEGABYTE


def safe_name(name: str, suffixes: tuple[str, ...]) -> str:
    """The name under which a file that a browser calls `name` may be stored.

    The folders in it are dropped, and with them any way out of the folder it is stored in; what
    is left are letters, digits, dots, dashes and underscores, and one of the endings.

    Raises:
        UsageError: If nothing is left of it, or its ending is another.
    """
    last = PurePosixPath(unicodedata.normalize("NFC", name).replace("\\", "/")).name
    ending = PurePosixPath(last).suffix.lower()
    if ending not in suffixes:
        kinds = ", ".join(suffix.lstrip(".").upper() for suffix in suffixes)
        shown = re.sub(r"[^\w .-]", "?", last)[:60] or "without a name"
        raise UsageError(f"The file {shown!r} cannot be used here. Drop one of these: {kinds}.")
    stem = re.sub(r"[^\w.-]+", "_", last[: -len(ending)]).strip("._-")[:_LONGEST_NAME] or "file"
    if _RESERVED.fullmatch(stem):
        stem = f"file_{stem}"
    return stem + ending


@dataclass(slots=True, kw_only=True)
class Inbox:
    """The folder of one tab's files, with its limits.

    Attributes:
        folder: Where they are stored.
        largest_picture_mb: Of one picture.
        largest_video_mb: Of one video, and of all files together.
        most_files: How many there may be.
    """

    folder: Path
    largest_picture_mb: int
    largest_video_mb: int
    most_files: int

    async def receive(
        self, name: str, chunks: AsyncIterator[bytes], suffixes: tuple[str, ...], *, batch: str = ""
    ) -> Path:
        """Store a file as it comes in; what is not complete is removed.

        Args:
            name: What the browser calls it.
            chunks: Its bytes.
            suffixes: Endings that it may have.
            batch: Files of one folder of frames share one; "" for a file alone.

        Raises:
            UsageError: If its name, its size or the number of files is not allowed.
            StorageError: If it cannot be stored.
        """
        safe = safe_name(name, suffixes)
        folder = self.folder / (safe_name(f"{batch}.png", (".png",))[:-4] if batch else "alone")
        try:
            if not batch:
                # One file at a time is looked at: the one before it is not needed any more.
                shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True, exist_ok=True)
            there = [file.stat().st_size for file in folder.iterdir()]
            if len(there) >= self.most_files:
                raise UsageError(
                    f"These are more than {self.most_files} files. Give the folder's path instead."
                )
            limit = self._limit_bytes(safe, sum(there))
            return await self._store(_free(folder / safe), chunks, limit)
        except OSError as error:
            if isinstance(error, StorageError):
                raise
            raise storage_error("write into", folder, error) from error

    def _limit_bytes(self, name: str, there: int) -> int:
        """How large a file may be; those of one batch together are at most as large as a video."""
        most = max(self.largest_video_mb, self.largest_picture_mb) * _MEGABYTE
        if PurePosixPath(name).suffix in VIDEOS:
            return self.largest_video_mb * _MEGABYTE
        return max(0, min(self.largest_picture_mb * _MEGABYTE, most - there))

    async def _store(self, path: Path, chunks: AsyncIterator[bytes], limit: int) -> Path:
        part = path.with_name(f".{path.name}.part")
        size = 0
        try:
            with part.open("wb") as file:
                async for chunk in chunks:
                    size += len(chunk)
                    if size > limit:
                        raise UsageError(
                            f"{path.name} is larger than {limit / _MEGABYTE:.0f} MB, which is the "
                            "most that is taken. Give its path on this machine instead, or start "
                            "the application with a higher limit."
                        )
                    if shutil.disk_usage(part.parent).free < _SPARE_BYTES:
                        raise StorageError(
                            f"The disk is nearly full, so {path.name} was not stored. Free some "
                            "space."
                        )
                    file.write(chunk)
            if size == 0:
                raise UsageError(f"{path.name} is empty. Choose another file.")
            part.replace(path)
        finally:
            with suppress(OSError):
                part.unlink(missing_ok=True)
        return path


def _free(path: Path) -> Path:
    """The path, or one with a number where there is such a file already."""
    number, found = 2, path
    while found.exists():
        found = path.with_name(f"{path.stem}-{number}{path.suffix}")
        number += 1
    return found

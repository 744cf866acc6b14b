"""What an EXR file says of itself: parts, windows, channels; read before any pixel is."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from panokit.errors import ImageError
from panokit.io.files import storage_error

MAGIC = b"\x76\x2f\x31\x01"
_DEEP = (OpenEXR.deepscanline, OpenEXR.deeptile)
# How many pixels a byte of file can stand for where the picture is black (measured: 151 at the
# most, with three channels; DWA and HTJ2K, whose chunks are large, grow with the width). A
# header that claims more lies.
_MOST_PIXELS_PER_BYTE = dict.fromkeys(
    ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A"), 600
)
_MOST_PIXELS_PER_BYTE_OF_OTHERS = 1 << 16
_LARGEST_TILE = 1 << 22


@dataclass(frozen=True, slots=True, kw_only=True)
class Window:
    """A rectangle of pixels, both ends within, y downward."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def width_px(self) -> int:
        """Columns."""
        return self.right - self.left + 1

    @property
    def height_px(self) -> int:
        """Rows."""
        return self.bottom - self.top + 1


@dataclass(frozen=True, slots=True, kw_only=True)
class ExrPart:
    """One part of an EXR file, without its pixels.

    Attributes:
        index: Its number in the file.
        name: Its name, "" where it has none.
        channels: Names of its channels.
        subsampled: Whether some channel has fewer pixels than the others.
        compression: "ZIP", "PIZ", "DWAA", ...
        data_window: The pixels that are stored.
        display_window: The picture they belong to.
        is_deep: Whether each pixel holds many samples.
        attributes: The header as the OpenEXR package gives it.
    """

    index: int
    name: str
    channels: tuple[str, ...]
    subsampled: bool
    compression: str
    data_window: Window
    display_window: Window
    is_deep: bool
    attributes: Mapping[str, Any] = field(default_factory=dict, repr=False)


def read_exr_parts(path: Path) -> list[ExrPart]:
    """The parts of an EXR file, from its header alone.

    Raises:
        ImageError: If it is not a readable EXR, or claims a size that its bytes cannot hold.
        StorageError: If the file cannot be opened.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            magic = file.read(4)
        size = path.stat().st_size
    except OSError as error:
        raise storage_error("read", path, error) from error
    if magic != MAGIC:
        raise ImageError(
            f"{path} is not an OpenEXR file (it begins with {magic.hex(' ') or 'nothing'}).",
            reason="not-an-image",
        )
    try:
        with OpenEXR.File(str(path), header_only=True) as file:
            # The package empties its headers when the file is closed.
            parts = [_part(index, dict(part.header)) for index, part in enumerate(file.parts)]
    except Exception as error:  # the package raises bare RuntimeError, ValueError and KeyError
        raise damaged(path, error) from error
    if not parts:
        raise damaged(path, "no parts")
    for part in parts:
        _check_size(path, part, size)
    return parts


def damaged(path: Path, why: BaseException | str) -> ImageError:
    """The error for a file that cannot be decoded."""
    if isinstance(why, UnicodeDecodeError):
        return ImageError(
            f"{path} has text in its header that is not UTF-8, or is damaged ({why}). "
            "Write its attributes again, for example with OpenEXR's exrstdattr.",
            reason="truncated",
        )
    text = str(why).strip().splitlines() if isinstance(why, str) or str(why).strip() else []
    first = text[0] if text else type(why).__name__
    return ImageError(
        f"{path} is a damaged OpenEXR file ({first}). Copy it again.", reason="truncated"
    )


def choose_part(path: Path, parts: list[ExrPart], part: int | str | None) -> ExrPart:
    """The part that was asked for, or the only one with a plain RGB picture.

    Raises:
        ImageError: If there is no such part, if several could be meant, or if it is deep.
    """
    chosen = _by_name_or_number(parts, part)
    if chosen is None:
        listed = ", ".join(
            f"{one.index} {one.name!r} ({', '.join(one.channels[:6])})" for one in parts
        )
        problem = f"has no part {part!r}" if part is not None else "has several parts"
        raise ImageError(
            f"{path} {problem}. Choose one with part=, by number or name: {listed}.",
            reason="wrong-part",
            values={"parts": [one.name for one in parts]},
        )
    if chosen.is_deep:
        raise ImageError(
            f"{path} holds deep samples, many for each pixel. "
            "Flatten it first (Nuke: DeepToImage; Houdini: write a flat EXR).",
            reason="deep",
        )
    return chosen


def _by_name_or_number(parts: list[ExrPart], part: int | str | None) -> ExrPart | None:
    if part is None:
        plain = [one for one in parts if {"R", "G", "B"} <= set(one.channels)]
        candidates = parts if len(parts) == 1 else plain
        return candidates[0] if len(candidates) == 1 else None
    for one in parts:
        if part in (one.name, one.index):
            return one
    return None


def _part(index: int, header: dict[str, Any]) -> ExrPart:
    channels = header["channels"]
    kind = header.get("type", OpenEXR.scanlineimage)
    return ExrPart(
        index=index,
        name=_text(header.get("name", "")),
        channels=tuple(channel.name for channel in channels),
        subsampled=any((channel.xSampling, channel.ySampling) != (1, 1) for channel in channels),
        compression=str(header["compression"]).split(".")[-1].split("_")[0],
        data_window=_window(header["dataWindow"]),
        display_window=_window(header["displayWindow"]),
        is_deep=kind in _DEEP,
        attributes=header,
    )


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _window(box: Any) -> Window:
    low, high = (np.asarray(corner).tolist() for corner in box)
    return Window(left=low[0], top=low[1], right=high[0], bottom=high[1])


def _check_size(path: Path, part: ExrPart, file_bytes: int) -> None:
    width, height = part.data_window.width_px, part.data_window.height_px
    if width < 1 or height < 1:
        raise damaged(path, f"a size of {width}x{height}")
    most = _MOST_PIXELS_PER_BYTE.get(part.compression, _MOST_PIXELS_PER_BYTE_OF_OTHERS)
    if width * height > most * file_bytes:
        raise ImageError(
            f"{path} claims {width}x{height} pixels but has only {file_bytes} bytes. "
            "It is damaged or was cut off; copy it again.",
            reason="truncated",
            values={"width_px": width, "height_px": height, "bytes": file_bytes},
        )
    tile = part.attributes.get("tiles")
    if tile is not None and tile.xSize * tile.ySize > max(_LARGEST_TILE, 4 * width * height):
        raise damaged(path, f"tiles of {tile.xSize}x{tile.ySize}")
    shown = part.display_window
    if shown.width_px < 1 or shown.height_px < 1 or (
        shown.width_px * shown.height_px > 64 * width * height + (1 << 20)
    ):  # fmt: skip
        raise ImageError(
            f"{path} stores {width}x{height} pixels of a picture that claims "
            f"{shown.width_px}x{shown.height_px}. Export it again without a crop.",
            reason="wrong-size",
        )

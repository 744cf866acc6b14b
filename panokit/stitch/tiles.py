"""One tile: from the bytes of its file to the pixels of its cell.

Services do not all send what their metadata promises. A body may be a full tile padded with
black beyond the picture's edge, a tile cropped at that edge, or a tile at half the size.
"""

import re
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import TileGrid
from panokit.errors import ImageError

_NAME = re.compile(r"^tiles/(\d+)_(\d+)\.\w+$")
# How the two formats that services send must end; a cut-off file decodes to half a picture.
_ENDINGS = {b"\xff\xd8": b"\xff\xd9", b"\x89PNG": b"IEND"}
_TRAILING_BYTES = 64


@dataclass(frozen=True, slots=True)
class Cell:
    """A tile's place in the picture, cut off at the picture's right and lower edge."""

    left: int
    top: int
    width: int
    height: int


def cell_of(grid: TileGrid, column: int, row: int) -> Cell:
    """The pixels that a tile covers."""
    left, top = column * grid.tile_width_px, row * grid.tile_height_px
    return Cell(
        left,
        top,
        min(grid.tile_width_px, grid.width_px - left),
        min(grid.tile_height_px, grid.height_px - top),
    )


def cell_from_name(name: str) -> tuple[int, int] | None:
    """(column, row) of a stored tile's name, "tiles/COLUMN_ROW.jpg", or None for other files."""
    match = _NAME.match(name)
    return (int(match[1]), int(match[2])) if match else None


def decode_tile(data: bytes, name: str) -> NDArray[np.uint8]:
    """The pixels of a tile's file as it is stored, (h, w, 3) uint8 RGB.

    Raises:
        ImageError: If it is truncated or not an image; the reason is "bad-tile".
    """
    ending = next((end for start, end in _ENDINGS.items() if data.startswith(start)), b"")
    if ending not in data[-_TRAILING_BYTES:]:
        raise _bad_tile(name, "is cut off before its end")
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR_RGB)
    except cv2.error:
        pixels = None
    if pixels is None:
        raise _bad_tile(name, "is not an image")
    return np.asarray(pixels, np.uint8)


def fit_tile(
    body: NDArray[np.uint8], grid: TileGrid, cell: Cell, name: str
) -> tuple[NDArray[np.uint8], bool]:
    """A decoded body as the pixels of its cell, and whether it had to be resized for that.

    Args:
        body: (h, w, 3), as the service sent it.
        grid: Says how large a full tile is.
        cell: Where the tile belongs.
        name: The tile's, for messages.

    Returns:
        (cell.height, cell.width, 3) uint8, and True if the body had another resolution.

    Raises:
        ImageError: If the body has the shape of neither the full nor the cropped tile.
    """
    height, width = body.shape[:2]
    full, cropped = (grid.tile_width_px, grid.tile_height_px), (cell.width, cell.height)
    if (width, height) == full:
        return body[: cell.height, : cell.width], False
    if (width, height) == cropped:
        return body, False
    for size in (full, cropped):
        if _same_shape((width, height), size):
            smaller = width < size[0]
            resized = cv2.resize(
                body, size, interpolation=cv2.INTER_LINEAR if smaller else cv2.INTER_AREA
            )
            return np.asarray(resized[: cell.height, : cell.width], np.uint8), True
    raise _bad_tile(name, f"is {width}x{height}, which is no version of a {full[0]}x{full[1]} tile")


def _same_shape(body: tuple[int, int], size: tuple[int, int]) -> bool:
    # A cropped edge may be an odd number of pixels, so half of it is rounded either way.
    scale = size[0] / body[0]
    return abs(body[1] * scale - size[1]) <= scale


def _bad_tile(name: str, complaint: str) -> ImageError:
    return ImageError(
        f"The tile {name} {complaint}. Fetch the capture again, or with --allow-missing to go "
        "on without the tile.",
        reason="bad-tile",
        values={"tile": name},
    )

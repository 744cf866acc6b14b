"""Black where a picture should be: tiles that were not there, frames of the wrong size.

Services answer 200 with a black tile for what they do not have, and a frame put together at
the wrong size has black bars. Both decode without complaint. A look at an eighth of the size
tells them: cameras leave noise, so that not even a night is exactly black from zenith to nadir.
"""

import threading
from collections.abc import Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import TileGrid
from panokit.errors import ImageError

SHRINK = 8  # a JPEG decodes to the means of its 8x8 blocks almost for free
_BLACK = 1
_NIGHT = 12.0
_MOST_BLACK = 0.5
_LARGEST_CAP = 0.25
_PLAIN_BYTES_PER_PIXEL, _HEADER_BYTES = 0.035, 2048

Cell = tuple[int, int]
# Progressive files are decoded in one piece: one of the large ones at a time is enough.
_LARGE_BYTES = 2 << 20
_one_large = threading.Lock()


def glance(data: bytes) -> NDArray[np.uint8]:
    """A picture in gray at an eighth of its size.

    Raises:
        ImageError: If it cannot be decoded (reason "not-an-image").
    """
    if len(data) < _LARGE_BYTES:
        return _decode(data)
    with _one_large:
        return _decode(data)


def is_too_rich_for_black(data: bytes, grid: TileGrid, cell: Cell) -> bool:
    """Whether a tile has so many bytes that it cannot be black, which saves decoding it.

    A constant JPEG takes about 0.02 bytes a pixel. Bars of black end at the right or lower edge
    of the picture, so tiles there, which may be black in part, are never too rich.
    """
    is_at_edge = cell[0] == grid.columns - 1 or cell[1] == grid.rows - 1
    plain_bytes = _PLAIN_BYTES_PER_PIXEL * grid.tile_width_px * grid.tile_height_px
    return not is_at_edge and len(data) > max(plain_bytes, _HEADER_BYTES)


def is_black(seen: NDArray[np.uint8]) -> bool:
    """Whether a glance shows nothing but black."""
    return bool(seen.max() <= _BLACK)


def lay_out(glances: Mapping[Cell, NDArray[np.uint8]], grid: TileGrid) -> NDArray[np.uint8]:
    """The glances of tiles in their places; white where there is none, or part of a block."""
    width, height = grid.tile_width_px // SHRINK, grid.tile_height_px // SHRINK
    frame = np.full((grid.height_px // SHRINK, grid.width_px // SHRINK), 255, np.uint8)
    for (column, row), seen in glances.items():
        place = frame[row * height : (row + 1) * height, column * width : (column + 1) * width]
        fitted = _fitted(seen, (width, height), (place.shape[1], place.shape[0]))
        place[: fitted.shape[0], : fitted.shape[1]] = fitted
    return frame


def lost_cells(glances: Mapping[Cell, NDArray[np.uint8]], grid: TileGrid) -> frozenset[Cell]:
    """The (column, row) of black tiles that are no night, for what lies beside them is bright.

    A black tile with nothing beside it counts as lost.
    """
    black = {cell for cell, seen in glances.items() if is_black(seen)}
    if not black:
        return frozenset()
    frame = lay_out(glances, grid)
    width, height = grid.tile_width_px // SHRINK, grid.tile_height_px // SHRINK
    dark = np.zeros(frame.shape, np.uint8)
    for column, row in black:
        dark[row * height : (row + 1) * height, column * width : (column + 1) * width] = 1
    count, regions = cv2.connectedComponents(dark, connectivity=4)
    lost = {
        number
        for number in range(1, count)
        if not _is_dark_around(frame, dark, (regions == number).astype(np.uint8))
    }
    return frozenset(cell for cell in black if regions[cell[1] * height, cell[0] * width] in lost)


def _is_dark_around(
    frame: NDArray[np.uint8], dark: NDArray[np.uint8], region: NDArray[np.uint8]
) -> bool:
    # Columns wrap: the last one lies beside the first.
    wrapped = np.pad(region, ((0, 0), (1, 1)), mode="wrap")
    around = cv2.dilate(wrapped, np.ones((3, 3), np.uint8))[:, 1:-1]
    rim = frame[(around > 0) & (dark == 0) & (frame < 255)]
    return rim.size > 0 and float(np.median(rim)) <= _NIGHT


def check_frame(frame: NDArray[np.uint8], what: str) -> None:
    """Refuse a frame with black bars, or one that is mostly black.

    Caps around zenith and nadir may be black, for some cameras do not see there.

    Args:
        frame: (h, w) uint8, gray, at an eighth of the size.
        what: The picture's name, for messages.

    Raises:
        ImageError: If it is refused ("black-frame", "black-rows", "black-columns").
    """
    black = np.asarray(frame <= _BLACK)
    share = float(black.mean())
    if share > _MOST_BLACK:
        raise _refusal("black-frame", f"{what} is black in {share:.0%} of its area", share)
    black_rows = np.all(black, axis=1)
    seen = np.flatnonzero(~black_rows)
    top, bottom = int(seen[0]), int(seen[-1]) + 1
    largest = max(top, len(frame) - bottom) / len(frame)
    if largest > _LARGEST_CAP or black_rows[top:bottom].any():
        bars = float(black_rows.mean())
        raise _refusal("black-rows", f"{what} has black rows, {bars:.0%} of them", bars)
    bars = float(np.all(black[top:bottom], axis=0).mean())
    if bars > 0:
        raise _refusal("black-columns", f"{what} has black columns, {bars:.0%} of them", bars)


def _decode(data: bytes) -> NDArray[np.uint8]:
    try:
        seen = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_REDUCED_GRAYSCALE_8)
    except cv2.error:
        seen = None
    if seen is None:
        raise ImageError("A picture cannot be decoded. Fetch it again.", reason="not-an-image")
    return np.asarray(seen, np.uint8)


def _fitted(
    seen: NDArray[np.uint8], full: tuple[int, int], cell: tuple[int, int]
) -> NDArray[np.uint8]:
    """A glance at the scale of its cell, cut to it: bodies come full, cropped, or smaller."""
    if seen.shape[1] in (full[0], cell[0]) or seen.shape[0] in (full[1], cell[1]):
        return seen[: cell[1], : cell[0]]
    scale = round(full[0] / seen.shape[1]) if seen.shape[1] else 1
    size = seen.shape[1] * scale, seen.shape[0] * scale
    resized = np.asarray(cv2.resize(seen, size, interpolation=cv2.INTER_NEAREST), np.uint8)
    return resized[: cell[1], : cell[0]]


def _refusal(reason: str, said: str, share: float) -> ImageError:
    return ImageError(
        f"{said}. The service may have answered for another size; fetch it again later.",
        reason=reason,
        values={"share": round(share, 4)},
    )

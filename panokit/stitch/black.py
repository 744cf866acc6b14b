"""Which all-black tiles stand for missing ones, and which for night.

Asked for a tile that it does not have, a service may answer with a black one. But a picture
taken at night may have black tiles too. The difference is at the border: night goes over
into its neighbors, a missing tile ends with a step.
"""

from collections.abc import Mapping
from statistics import median

import numpy as np
from numpy.typing import NDArray

from panokit.capture import TileGrid
from panokit.io.captures import StoredCapture
from panokit.stitch.tiles import cell_of, decode_tile, fit_tile

# A constant JPEG takes about 0.02 bytes a pixel, a dark but real one several times that, so
# that only files this small need to be decoded to know.
_SUSPECT_BYTES_PER_PIXEL = 0.035
_HEADER_BYTES = 2048
_BLACK_MEAN, _BLACK_SPREAD = 2.0, 0.5
_NIGHT_MEAN = 12.0

CellIndex = tuple[int, int]


def black_cells_that_are_missing(
    stored: StoredCapture, grid: TileGrid, names: Mapping[CellIndex, str]
) -> frozenset[CellIndex]:
    """(column, row) of the tiles that are black, and whose neighbors are not dark beside them.

    Args:
        stored: The capture.
        grid: How its tiles lie.
        names: The file of each stored tile, by (column, row).
    """
    black = {cell for cell, name in names.items() if _is_black(stored, grid, name)}
    missing: set[CellIndex] = set()
    while black:
        region = _connected(black, black.pop(), grid)
        black -= region
        levels = [
            _edge_level(stored, grid, neighbor, names[neighbor], side)
            for cell in region
            for side, neighbor in _neighbors(cell, grid)
            if neighbor in names and neighbor not in region
        ]
        # Without a single neighbor there is nothing to tell night by, so it is taken as missing.
        if not levels or median(levels) > _NIGHT_MEAN:
            missing |= region
    return frozenset(missing)


def _is_black(stored: StoredCapture, grid: TileGrid, name: str) -> bool:
    suspect_bytes = _SUSPECT_BYTES_PER_PIXEL * grid.tile_width_px * grid.tile_height_px
    # The size alone rules out nearly all of them, without reading.
    try:
        size = (stored.folder / name).stat().st_size
    except OSError:
        size = 0  # reading it says what is wrong
    if size > max(suspect_bytes, _HEADER_BYTES):
        return False
    pixels = decode_tile(stored.read(name), name)
    return bool(pixels.mean() < _BLACK_MEAN and pixels.std() < _BLACK_SPREAD)


def _connected(black: set[CellIndex], start: CellIndex, grid: TileGrid) -> set[CellIndex]:
    region, open_cells = {start}, [start]
    while open_cells:
        for _, neighbor in _neighbors(open_cells.pop(), grid):
            if neighbor in black and neighbor not in region:
                region.add(neighbor)
                open_cells.append(neighbor)
    return region


def _neighbors(cell: CellIndex, grid: TileGrid) -> list[tuple[str, CellIndex]]:
    """The cells beside a cell, each with the side of it that touches; columns wrap."""
    column, row = cell
    beside = [
        ("right", ((column - 1) % grid.columns, row)),
        ("left", ((column + 1) % grid.columns, row)),
        ("bottom", (column, row - 1)),
        ("top", (column, row + 1)),
    ]
    return [(side, other) for side, other in beside if 0 <= other[1] < grid.rows]


_EDGES: dict[str, tuple[slice | int, slice | int]] = {
    "left": (slice(None), 0),
    "right": (slice(None), -1),
    "top": (0, slice(None)),
    "bottom": (-1, slice(None)),
}


def _edge_level(
    stored: StoredCapture, grid: TileGrid, index: CellIndex, name: str, side: str
) -> float:
    body = decode_tile(stored.read(name), name)
    pixels, _ = fit_tile(body, grid, cell_of(grid, *index), name)
    edge: NDArray[np.uint8] = pixels[_EDGES[side]]
    return float(edge.mean())

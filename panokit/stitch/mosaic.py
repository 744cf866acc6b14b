"""Tiles to one picture, at the size that the metadata says.

The width of a tile grid at some zoom is not a power of two times the tile: asking for one
leaves black bars. Threads decode the tiles, since OpenCV lets go of Python's lock, and copy
them straight to their place.
"""

import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from panokit.capture import TileGrid
from panokit.errors import ImageError
from panokit.io.captures import StoredCapture
from panokit.stitch.black import CellIndex, black_cells_that_are_missing
from panokit.stitch.deblock import deblock
from panokit.stitch.reduce import Reducer
from panokit.stitch.tiles import cell_from_name, cell_of, decode_tile, fit_tile

_MOST_THREADS = 8


@dataclass(slots=True)
class Mosaic:
    """One picture put together from tiles, and what was wrong with them.

    Attributes:
        pixels: (H, W, 3) uint8; black where not valid.
        valid: (H, W) bool, or None if all is valid.
        tiles: How many cells the grid has.
        missing: (column, row) of the tiles that the capture says are missing.
        black: (column, row) of stored tiles that are black in place of a picture.
        resized: (column, row) of the tiles that came at another resolution.
    """

    pixels: NDArray[np.uint8]
    valid: NDArray[np.bool_] | None
    tiles: int
    missing: list[CellIndex]
    black: list[CellIndex]
    resized: list[CellIndex]


def mosaic(
    stored: StoredCapture, grid: TileGrid, width_px: int | None, *, soften: bool = False
) -> Mosaic:
    """Put the stored tiles of a capture together.

    Args:
        stored: The capture.
        grid: Its tile grid.
        width_px: The result is averaged to this width while it is put together, so that the
            whole mosaic is never in memory; None, or one not smaller, keeps the native size.
        soften: Soften the steps between tiles; a picture that is averaged to half its size or
            less shows none.

    Raises:
        ImageError: If a tile is damaged, not stored though not said to be missing
            ("bad-tile"), or if there is none at all ("no-tiles").
    """
    plan = _plan(stored, grid)
    if width_px is not None and width_px < grid.width_px:
        reducer = Reducer(grid.width_px, width_px)
        for top, pixels, valid in _bands(plan, None):
            reducer.add(top, pixels, valid)
        pixels, valid = reducer.result()
    else:
        pixels = np.zeros((grid.height_px, grid.width_px, 3), np.uint8)
        for _ in _bands(plan, pixels):
            pass
        valid = _valid_rows(plan, range(grid.rows))
        if soften:
            deblock(pixels, grid)
            if valid is not None:
                pixels[~valid] = 0
    return Mosaic(
        pixels=pixels,
        valid=valid,
        tiles=grid.columns * grid.rows,
        missing=sorted(set(grid.missing)),
        black=sorted(plan.black),
        resized=sorted(plan.resized),
    )


@dataclass(slots=True)
class _Plan:
    stored: StoredCapture
    grid: TileGrid
    names: dict[CellIndex, str]
    black: frozenset[CellIndex]
    resized: list[CellIndex] = field(default_factory=list)


def _plan(stored: StoredCapture, grid: TileGrid) -> _Plan:
    named = {cell_from_name(name): name for name in stored.files}
    absent = set(grid.missing)
    names: dict[CellIndex, str] = {}
    for cell in grid.cells():
        if cell in absent:
            continue
        if cell not in named:
            raise ImageError(
                f"The tile {cell[0]}_{cell[1]} of {stored.capture.id} is neither stored nor "
                "recorded as missing. Fetch the capture again.",
                reason="bad-tile",
                values={"tile": f"{cell[0]}_{cell[1]}"},
            )
        names[cell] = named[cell]
    black = black_cells_that_are_missing(stored, grid, names)
    if len(black) == len(names):
        raise ImageError(
            f"All {len(grid.cells())} tiles of {stored.capture.id} are missing or black. "
            "Fetch the capture again, or leave it out.",
            reason="no-tiles",
        )
    usable = {cell: name for cell, name in names.items() if cell not in black}
    return _Plan(stored, grid, usable, black)


def _bands(
    plan: _Plan, whole: NDArray[np.uint8] | None
) -> Iterator[tuple[int, NDArray[np.uint8], NDArray[np.bool_] | None]]:
    """Each row of tiles once it is decoded: its first pixel row, its pixels, its valid mask.

    The pixels are views of `whole` where it is given, else of one buffer used again and again.
    """
    grid = plan.grid
    buffer_rows = grid.tile_height_px if whole is None else 0
    buffer = np.zeros((buffer_rows, grid.width_px, 3), np.uint8)
    with ThreadPoolExecutor(min(os.cpu_count() or 1, _MOST_THREADS)) as threads:
        for row in range(grid.rows):
            top = row * grid.tile_height_px
            height = min(grid.tile_height_px, grid.height_px - top)
            band = buffer[:height] if whole is None else whole[top : top + height]
            cells = [cell for cell in plan.names if cell[1] == row]
            done = threads.map(lambda cell, band=band: _paste(plan, cell, band), cells)
            plan.resized.extend(cell for cell, resized in zip(cells, done, strict=True) if resized)
            yield top, band, _valid_rows(plan, range(row, row + 1))


def _paste(plan: _Plan, index: CellIndex, band: NDArray[np.uint8]) -> bool:
    name = plan.names[index]
    cell = cell_of(plan.grid, *index)
    body = decode_tile(plan.stored.read(name), name)
    pixels, resized = fit_tile(body, plan.grid, cell, name)
    band[:, cell.left : cell.left + cell.width] = pixels
    return resized


def _valid_rows(plan: _Plan, rows: range) -> NDArray[np.bool_] | None:
    """The valid mask of some rows of tiles, or None if no tile of theirs is missing."""
    grid = plan.grid
    absent = [(x, y) for y in rows for x in range(grid.columns) if (x, y) not in plan.names]
    if not absent:
        return None
    top = rows.start * grid.tile_height_px
    bottom = min(rows.stop * grid.tile_height_px, grid.height_px)
    valid = np.ones((bottom - top, grid.width_px), np.bool_)
    for index in absent:
        cell = cell_of(grid, *index)
        valid[cell.top - top :][: cell.height, cell.left : cell.left + cell.width] = False
    return valid

"""The sparse reflectance map: what each orientation of a surface looks like, where it is seen.

For every normal of the half sphere the pixels are gathered whose own normal is within a gate
of it, 5 degrees if not said otherwise; one of them, or their mean, is the cell's color. The
rule of the 2018 thesis's program is `Rule.BRIGHTEST`: of several pixels with one orientation
the darker ones lie in shadow. Where no pixel has such a normal, the cell is empty.

This is the reference: simple and exact. `panokit.networks` has the same for batches.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.errors import UsageError
from panokit.reflectance.grid import hemisphere_normals, reach_in_cells

GATE_DEG = 5.0
_TOP = 5


class Rule(StrEnum):
    """Which color a cell takes from the pixels within its gate.

    BRIGHTEST: that of the pixel with the highest luminance (the thesis's program). WEIGHTED: of
    the highest luminance times the cosine between the pixel's and the cell's normal (the
    thesis's formula). MEDIAN: of the pixel with the median luminance, the lower of two. TOP: the
    mean of the five brightest.
    """

    BRIGHTEST = "brightest"
    WEIGHTED = "weighted"
    MEDIAN = "median"
    TOP = "top"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SparseReflectance:
    """Colors by normal.

    Attributes:
        color: (W, W, 3) float32, on the scale of the picture; zero where a cell is empty.
        hits: (W, W) int32, how many pixels lie within each cell's gate.
    """

    color: NDArray[np.float32]
    hits: NDArray[np.int32]

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(W, W), where the map says anything."""
        return self.hits > 0


def sparse_reflectance(
    picture: NDArray[np.floating[Any]],
    normals: NDArray[np.floating[Any]],
    mask: NDArray[np.bool_],
    *,
    width_px: int = 64,
    gate_deg: float = GATE_DEG,
    rule: Rule = Rule.BRIGHTEST,
) -> SparseReflectance:
    """Gather the colors of an object's pixels by their normals.

    Args:
        picture: (H, W, 3), linear or display-encoded.
        normals: (H, W, 3) in the camera's frame, of unit length where `mask` is true; those
            that look away from the camera count for no cell that they cannot reach.
        mask: (H, W), the object's pixels.
        width_px: Of the map.
        gate_deg: How far a pixel's normal may be from a cell's.
        rule: See `Rule`; of equal pixels the first counts, row by row.

    Raises:
        UsageError: If the shapes do not fit, or a value is not finite.
    """
    _check(picture, normals, mask, gate_deg)
    colors = np.asarray(picture, np.float32)[mask]
    own = np.asarray(normals, np.float32)[mask]
    # In double precision: rounding must not decide which of two pixels is brighter.
    light = luminance(colors.astype(np.float64))
    cells = width_px * width_px
    if rule is not Rule.BRIGHTEST:
        cell, pixel, cosine = _pairs(own, width_px, gate_deg)
        hits = np.bincount(cell, minlength=cells).astype(np.int32)
        found = _by_rule(rule, cell, pixel, cosine, colors, light, hits)
        return _as_map(found, hits, width_px)
    best, hits = brightest_pixels(light, own, width_px=width_px, gate_deg=gate_deg)
    found = np.zeros((cells, 3), np.float32)
    found[best >= 0] = colors[best[best >= 0]]
    return _as_map(found, hits, width_px)


def brightest_pixels(
    light: NDArray[np.floating[Any]],
    own: NDArray[np.float32],
    *,
    width_px: int = 64,
    gate_deg: float = GATE_DEG,
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Which pixel each cell takes its color from by `Rule.BRIGHTEST`.

    Args:
        light: (N,), how bright the pixels are.
        own: (N, 3), their normals.
        width_px: Of the map.
        gate_deg: How far a pixel's normal may be from a cell's.

    Returns:
        (W * W,) the pixel's number, or -1 where a cell is empty; (W * W,) hits.
    """
    order = _from_dark_to_bright(light)
    grid = _grid_of(width_px, gate_deg)
    best = np.full(grid.size, -1, np.int64)
    hits = np.zeros(grid.size, np.int64)
    count = grid.size - grid.last
    for shift, home, place, _ in _within_gate(own.take(order, axis=0), grid):
        # Of what is written to one place, the last stays: the brightest.
        brightest = np.full(count, -1, np.int64)
        brightest[home] = place
        there = slice(shift, shift + count)
        np.maximum(best[there], brightest, out=best[there])
        hits[there] += np.bincount(home, minlength=count)
    best, hits = best[grid.cells], hits[grid.cells]
    return np.where(best >= 0, order[best], -1) if len(order) else best, hits.astype(np.int32)


def _from_dark_to_bright(light: NDArray[np.floating[Any]]) -> NDArray[np.int64]:
    """The order of pixels by their light, and of equal ones from last to first.

    Two sorts of plain numbers take less than one that is stable.
    """
    order = np.argsort(light)
    ranked = light[order]
    group = np.concatenate([[0], np.cumsum(ranked[1:] != ranked[:-1])])[: len(light)]
    return -np.sort(group * len(light) - order) % max(len(light), 1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Grid:
    """The cells' normals with a margin around them, row by row.

    Attributes:
        width: Cells in a row of the map.
        wide: Cells in a row, margins included.
        across: (wide,), the normals' x by column, and -y by row.
        z: (size,), the normals' z; NaN where there is no normal, which is near to none.
        reach: For each row within reach of a pixel's own, less the margin: itself, and the columns
            of the cells there, less the margin.
        last: The largest step from a pixel's own cell, less the margin, to one within its reach.
        cells: (W * W,), where the map's cells are.
        least: The cosine at the edge of the gate.
    """

    width: int
    wide: int
    across: NDArray[np.float32]
    z: NDArray[np.float32]
    reach: tuple[tuple[int, tuple[int, ...]], ...]
    last: int
    cells: NDArray[np.int64]
    least: np.float32

    @property
    def size(self) -> int:
        """How many cells there are, margins included."""
        return len(self.z)


@lru_cache(maxsize=8)
def _grid_of(width_px: int, gate_deg: float) -> _Grid:
    normals, inside = hemisphere_normals(width_px)
    offsets = reach_in_cells(gate_deg, width_px)
    margin = max(abs(row) for row, _ in offsets)
    wide = width_px + 2 * margin
    middle = slice(margin, margin + width_px)
    z = np.full((wide, wide), np.nan, np.float32)
    z[middle, middle][inside] = normals[inside][:, 2]
    across = ((np.arange(wide) - margin + 0.5) * 2 / width_px - 1).astype(np.float32)
    reach = tuple(
        (margin + row, tuple(margin + column for other, column in offsets if other == row))
        for row in range(-margin, margin + 1)
    )
    cells = np.arange(wide * wide).reshape(wide, wide)[middle, middle].reshape(-1)
    return _Grid(width=width_px, wide=wide, across=across, z=z.reshape(-1), reach=reach,
                 last=max(row * wide + column for row, columns in reach for column in columns),
                 cells=cells, least=np.float32(np.cos(np.deg2rad(gate_deg))))  # fmt: skip


def _within_gate(
    own: NDArray[np.float32], grid: _Grid
) -> Iterator[tuple[int, NDArray[np.int64], NDArray[np.int64], NDArray[np.float32]]]:
    """For each shift: itself, and home, place in `own` and cosine of what lies within the gate.

    The cell that a pixel then counts for is its home plus the shift.
    """
    x, y, z = np.ascontiguousarray(own.T)
    half = grid.width / 2
    column = np.clip(((x + 1) * half).astype(np.int64), 0, grid.width - 1)
    row = np.clip(((1 - y) * half).astype(np.int64), 0, grid.width - 1)
    home = row * grid.wide + column
    # A cell's x is that of its column and its y that of its row: few products for many cells.
    columns = sorted({column for _, columns in grid.reach for column in columns})
    by_x = {right: grid.across[right:][column] * x for right in columns}
    cosine, part = np.empty_like(x), np.empty_like(x)
    for down, columns_there in grid.reach:
        by_y = -grid.across[down:][row] * y
        for right in columns_there:
            shift = down * grid.wide + right
            # In this order, as the torch twin does: its sums are rounded alike.
            np.add(by_x[right], by_y, out=cosine)
            np.take(grid.z[shift:], home, out=part, mode="clip")
            part *= z
            cosine += part
            near = np.flatnonzero(cosine > grid.least)
            yield shift, home.take(near, mode="clip"), near, cosine


def _pairs(
    own: NDArray[np.float32], width_px: int, gate_deg: float
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float32]]:
    """All (cell, pixel, cosine) within the gate."""
    grid = _grid_of(width_px, gate_deg)
    number = np.zeros(grid.size, np.int64)
    number[grid.cells] = np.arange(width_px * width_px)
    found = [
        (number[home + shift], near, cosine[near])
        for shift, home, near, cosine in _within_gate(own, grid)
    ]
    cells, pixels, cosines = zip(*found, strict=True)
    return np.concatenate(cells), np.concatenate(pixels), np.concatenate(cosines)


def _by_rule(
    rule: Rule,
    cell: NDArray[np.int64],
    pixel: NDArray[np.int64],
    cosine: NDArray[np.float32],
    colors: NDArray[np.float32],
    light: NDArray[np.floating[Any]],
    hits: NDArray[np.int32],
) -> NDArray[np.float32]:
    found = np.zeros((len(hits), 3), np.float32)
    if len(cell) == 0:
        return found
    value = light[pixel] * cosine if rule is Rule.WEIGHTED else light[pixel]
    # By cell, then from bright to dark, then in the order of the picture.
    order = np.lexsort((pixel, -value, cell))
    cell, pixel = cell[order], pixel[order]
    first = np.concatenate([[0], np.cumsum(hits)[:-1]])
    filled = hits > 0
    if rule is Rule.TOP:
        rank = np.arange(len(cell)) - first[cell]
        taken = rank < _TOP
        np.add.at(found, cell[taken], colors[pixel[taken]])
        found[filled] /= np.minimum(hits[filled], _TOP)[:, None]
        return found
    place = first + hits // 2 if rule is Rule.MEDIAN else first
    found[filled] = colors[pixel[place[filled]]]
    return found


def _as_map(
    found: NDArray[np.float32], hits: NDArray[np.int32], width_px: int
) -> SparseReflectance:
    return SparseReflectance(
        color=found.reshape(width_px, width_px, 3), hits=hits.reshape(width_px, width_px)
    )


def _check(
    picture: NDArray[Any], normals: NDArray[Any], mask: NDArray[Any], gate_deg: float
) -> None:
    shape = mask.shape
    if len(shape) != 2 or picture.shape != (*shape, 3) or normals.shape != (*shape, 3):
        raise UsageError(
            f"A picture (H, W, 3), its normals (H, W, 3) and its mask (H, W) go together, not "
            f"{picture.shape}, {normals.shape} and {shape}."
        )
    if not 0 < gate_deg < 90:
        raise UsageError(f"A gate is more than 0 and less than 90 degrees wide, not {gate_deg}.")
    chosen = np.asarray(mask, bool)
    if not (np.isfinite(picture[chosen]).all() and np.isfinite(normals[chosen]).all()):
        raise UsageError("The object's colors and normals must be finite. Leave such pixels out.")

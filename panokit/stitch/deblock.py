"""The step between two tiles, which were compressed apart, softened by a pixel on either side."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.capture import TileGrid

# In codes: a larger step is an edge of the scene. Compression makes steps of a few.
_LARGEST_STEP = 12.0


def deblock(pixels: NDArray[np.uint8], grid: TileGrid) -> None:
    """Soften the steps across the edges of tiles, in place; also from the last column to the first.

    A step is what the difference across the edge has beyond the differences inside the tiles
    on either side, so slopes stay. A quarter of it is taken off each side, which halves it.

    Args:
        pixels: (H, W, 3) uint8, the whole mosaic.
        grid: How its tiles lie.
    """
    width, height = grid.width_px, grid.height_px
    for left in range(0, width, grid.tile_width_px):
        _soften(*(pixels[:, (left + offset) % width] for offset in (-2, -1, 0, 1)))
    for top in range(grid.tile_height_px, height - 1, grid.tile_height_px):
        _soften(*(pixels[top + offset] for offset in (-2, -1, 0, 1)))


def _soften(before: Any, last: Any, first: Any, after: Any) -> None:
    inner, a, b, outer = (np.asarray(p, np.float32) for p in (before, last, first, after))
    step = (b - a) - ((a - inner) + (outer - b)) / 2
    # Fades out toward the largest, so that an edge of the scene is not cut in two.
    share = np.clip(1 - np.abs(step) / _LARGEST_STEP, 0, 1) * 0.25
    last[...] = np.clip(np.rint(a + share * step), 0, 255)
    first[...] = np.clip(np.rint(b - share * step), 0, 255)

"""What overlapping views show of the same directions, at low resolution.

Exposure, vignetting and poses are found from these samples: one row per view, one column
per direction of a coarse grid over the sphere.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import View
from panokit.color import srgb_decode_u8
from panokit.sphere import equirect_directions, pixel_solid_angles
from panokit.stitch.layout import project, scaled

Picture = NDArray[np.uint8] | NDArray[np.float32]

CLIPPED_CODE = 254
_CLIPPED_SHARE = 0.02
_MARGIN_PX = 1.0
_BLOCK_PX = 2048


@dataclass(frozen=True, slots=True, eq=False)
class Thumbnail:
    """A small copy of a view in linear light.

    Attributes:
        view: With the small copy's size.
        linear: (h, w, 3) float32.
        usable: (h, w) float32, 0 where masked or clipped, else 1.
    """

    view: View
    linear: NDArray[np.float32]
    usable: NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Overlaps:
    """Samples of all views on one grid of directions.

    Attributes:
        linear: (V, P, 3) float32; 0 where a view does not show the direction.
        weight: (V, P) float32, 0 where it does not, else the solid angle of the direction.
        radius2: (V, P) float32, squared distance from the view's center, 1 in its corners.
    """

    linear: NDArray[np.float32]
    weight: NDArray[np.float32]
    radius2: NDArray[np.float32]

    @property
    def shared(self) -> NDArray[np.float64]:
        """(V, V) solid angle in steradians that each pair of views shares."""
        seen = (self.weight > 0).astype(np.float32)
        return np.asarray(self.weight @ seen.T, np.float64)


def thumbnail(picture: Picture, view: View, size_px: int) -> Thumbnail:
    """A copy of a view whose longer side is `size_px`, or the view itself if it is smaller.

    Code values are averaged before they are decoded: the sRGB curve is close to a power, for
    which the ratio of two exposures is the same before and after, and bytes are quick.
    """
    scale = min(1.0, size_px / max(view.width_px, view.height_px))
    width, height = max(2, round(view.width_px * scale)), max(2, round(view.height_px * scale))
    small = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
    usable = np.ones((height, width), np.float32)
    reduced = scaled(view, width, height)
    for left, top, right, bottom in reduced.masked_px:
        usable[max(top - 1, 0) : bottom + 1, max(left - 1, 0) : right + 1] = 0
    if small.dtype == np.uint8:
        usable[small.max(axis=-1) >= CLIPPED_CODE - 6] = 0
        return Thumbnail(reduced, srgb_decode_u8(np.asarray(small, np.uint8)), usable)
    return Thumbnail(reduced, np.asarray(small, np.float32), usable)


def sample_overlaps(thumbnails: Sequence[Thumbnail], grid_width_px: int) -> Overlaps:
    """Read all views on an equirectangular grid of directions."""
    directions = equirect_directions(grid_width_px, grid_width_px // 2).reshape(-1, 3)
    rows = pixel_solid_angles(grid_width_px // 2)
    angles = np.repeat(rows[:, 0], grid_width_px).astype(np.float32)
    count = len(thumbnails)
    linear = np.zeros((count, len(directions), 3), np.float32)
    weight = np.zeros((count, len(directions)), np.float32)
    radius2 = np.zeros((count, len(directions)), np.float32)
    for number, small in enumerate(thumbnails):
        seen, column, row = visible(small.view, directions)
        usable = read_at(small.usable, column, row)
        linear[number, seen] = read_at(small.linear, column, row)
        weight[number, seen] = np.where(usable > 1 - _CLIPPED_SHARE, angles[seen], 0)
        radius2[number, seen] = radius_squared(small.view, column, row)
    return Overlaps(linear, weight, radius2)


def visible(
    view: View, directions: NDArray[np.float32]
) -> tuple[NDArray[np.intp], NDArray[np.float32], NDArray[np.float32]]:
    """Which of directions (P, 3) a view shows, and their columns and rows, each (n,)."""
    column, row, depth = project(view, directions)
    inside = (
        (depth > 0)
        & (column >= _MARGIN_PX) & (column <= view.width_px - 1 - _MARGIN_PX)
        & (row >= _MARGIN_PX) & (row <= view.height_px - 1 - _MARGIN_PX)
    )  # fmt: skip
    seen = np.flatnonzero(inside)
    return seen, column[seen], row[seen]


def read_at(
    picture: NDArray[np.float32], column: NDArray[np.float32], row: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Linear interpolation at a list of places, (n[, C])."""
    # cv2.remap takes nothing of 32768 or more on a side, so the list becomes a block.
    count = len(column)
    block = np.zeros((2, -(-max(count, 1) // _BLOCK_PX) * _BLOCK_PX), np.float32)
    block[0, :count], block[1, :count] = column, row
    places = block.reshape(2, -1, _BLOCK_PX)
    read = cv2.remap(
        picture, places[0], places[1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    return np.asarray(read.reshape(-1, *picture.shape[2:])[:count], np.float32)


def radius_squared(
    view: View, column: NDArray[np.float32], row: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Squared distance from the center of a view, 1 in its corners."""
    x, y = column - (view.width_px - 1) / 2, row - (view.height_px - 1) / 2
    return np.asarray((x * x + y * y) * 4 / (view.width_px**2 + view.height_px**2), np.float32)

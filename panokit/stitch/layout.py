"""Where the pixels of a panorama lie in each of its views: made once per layout, then kept.

Services ask for the same views again and again, so the maps of a layout are worth keeping:
making them costs more than all the rest. A view covers a part of the panorama only; its map
is cut into strips of rows, each as wide as the view is there, across the wrap too.
"""

from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from threading import Lock
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import View
from panokit.frames import Rotation

STRIP_ROWS = 64
_CACHE_BYTES = 384 << 20
_COARSE_PX = 4
# Behind the camera there is no pixel; any place far outside the view says so.
_NOWHERE = np.float32(-16384)


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A rectangle of the panorama and where its pixels lie in one view.

    Attributes:
        top: First row, may be negative: beyond the zenith the sphere goes on.
        left: First column, in [0, W).
        column: (h, w) float32, column in the view; columns of the patch wrap.
        row: (h, w) float32.
    """

    top: int
    left: int
    column: NDArray[np.float32]
    row: NDArray[np.float32]


def view_patches(view: View, width_px: int) -> tuple[Patch, ...]:
    """The strips of a panorama of this width that a view covers."""
    return _kept.get(
        ("strips", _geometry(view), width_px),
        lambda: tuple(
            _patch(view, width_px, top, height, left, width)
            for top, height, left, width in _strips(view, width_px)
        ),
    )


def padded_patch(view: View, width_px: int, pad_px: int) -> Patch:
    """One rectangle around all that a view covers, larger by a border on each side.

    Its corner and size are multiples of `pad_px`, so that it can be halved as often as the
    panorama itself.
    """

    def make() -> tuple[Patch, ...]:
        strips = _strips(view, width_px)
        top = min(strip[0] for strip in strips)
        bottom = max(strip[0] + strip[1] for strip in strips)
        left, width = _union([(strip[2], strip[3]) for strip in strips], width_px)
        first = (top // pad_px - 1) * pad_px
        last = (-(-bottom // pad_px) + 1) * pad_px
        start = (left // pad_px - 1) * pad_px
        end = (-(-(left + width) // pad_px) + 1) * pad_px
        if end - start > width_px:
            start, end = 0, width_px
        return (_patch(view, width_px, first, last - first, start % width_px, end - start),)

    return _kept.get(("padded", _geometry(view), width_px, pad_px), make)[0]


def project(view: View, directions: NDArray[Any]) -> tuple[NDArray[np.float32], ...]:
    """Column, row and depth in a view of directions (..., 3); column and row are nowhere behind."""
    local = directions @ view.world_from_view.matrix.astype(directions.dtype)
    return _to_pixels(view, local[..., 0], local[..., 1], -local[..., 2])


def focal_px(view: View) -> float:
    """Distance of the image plane in pixels."""
    return float(view.width_px / 2 / np.tan(np.deg2rad(view.fov_deg) / 2))


def reposed(view: View, world_from_view: Rotation) -> View:
    """The view with another pose."""
    heading, pitch, roll = (float(np.rad2deg(a)) for a in world_from_view.heading_pitch_roll())
    return replace(view, heading_deg=heading, pitch_deg=pitch, roll_deg=roll)


def scaled(view: View, width_px: int, height_px: int) -> View:
    """The view as a picture of another size shows it."""
    x, y = width_px / view.width_px, height_px / view.height_px
    boxes = tuple(
        (int(left * x), int(top * y), int(np.ceil(right * x)), int(np.ceil(bottom * y)))
        for left, top, right, bottom in view.masked_px
    )
    return replace(view, width_px=width_px, height_px=height_px, masked_px=boxes)


def _geometry(view: View) -> tuple[Any, ...]:
    return (view.heading_deg, view.pitch_deg, view.roll_deg, view.fov_deg,
            view.width_px, view.height_px)  # fmt: skip


def _patch(view: View, width_px: int, top: int, height: int, left: int, width: int) -> Patch:
    rows = np.arange(top, top + height)
    columns = np.arange(left, left + width)
    column, row, _ = _locate(view, width_px, rows, columns)
    return Patch(top, left % width_px, column, row)


def _locate(
    view: View, width_px: int, rows: NDArray[Any], columns: NDArray[Any]
) -> tuple[NDArray[np.float32], ...]:
    """Column, row and depth in the view of a grid of panorama pixels.

    A direction is a product of a function of its row and one of its column, so the rotation
    is applied to rows and columns apart.
    """
    azimuth = ((columns + 0.5) / width_px - 0.5) * (2 * np.pi)
    elevation = (0.5 - (rows + 0.5) / (width_px / 2)) * np.pi
    across, ahead = np.sin(azimuth), -np.cos(azimuth)
    matrix = view.world_from_view.matrix
    flat, up = np.cos(elevation).astype(np.float32)[:, None], np.sin(elevation)[:, None]
    x, y, z = (
        flat * (matrix[0, k] * across + matrix[2, k] * ahead).astype(np.float32)[None, :]
        + (matrix[1, k] * up).astype(np.float32)
        for k in range(3)
    )
    return _to_pixels(view, x, y, -z)


def _to_pixels(
    view: View, x: NDArray[Any], y: NDArray[Any], depth: NDArray[Any]
) -> tuple[NDArray[np.float32], ...]:
    focal = np.float32(focal_px(view))
    ahead = depth > 0.02
    scale = focal / np.where(ahead, depth, np.float32(1))
    column = np.where(ahead, x * scale + np.float32((view.width_px - 1) / 2), _NOWHERE)
    row = np.where(ahead, np.float32((view.height_px - 1) / 2) - y * scale, _NOWHERE)
    # cv2.remap addresses with 16 bits.
    limit = np.float32(16384)
    return (
        np.clip(column, -limit, limit).astype(np.float32, copy=False),
        np.clip(row, -limit, limit).astype(np.float32, copy=False),
        np.asarray(depth, np.float32),
    )


def _strips(view: View, width_px: int) -> list[tuple[int, int, int, int]]:
    """(top, height, left, width) of the strips that the view covers."""
    height_px, step = width_px // 2, max(1, min(_COARSE_PX, width_px // 256))
    rows, columns = np.arange(0, height_px, step), np.arange(0, width_px, step)
    column, row, _ = _locate(view, width_px, rows, columns)
    margin = 0.5
    seen = (
        (column >= -margin - 0.5) & (column <= view.width_px - 0.5 + margin)
        & (row >= -margin - 0.5) & (row <= view.height_px - 0.5 + margin)
    )  # fmt: skip
    strips = []
    per_strip = max(1, STRIP_ROWS // step)
    # One coarse pixel more on every side: what lies between two that are not seen may be.
    tall = cv2.dilate(seen.astype(np.uint8), np.ones((3, 1), np.uint8))
    for start in range(0, len(rows), per_strip):
        any_row = tall[start : start + per_strip].any(axis=0)
        if not any_row.any():
            continue
        left, width = _span(np.asarray(any_row))
        top = start * step
        bottom = min(top + per_strip * step, height_px)
        left, right = (left - 1) * step, (left + width + 1) * step
        if right - left >= width_px:
            left, right = 0, width_px
        strips.append((top, bottom - top, left % width_px, right - left))
    # A view smaller than the coarse pixels is somewhere all the same.
    return strips or [_smallest(view, width_px)]


def _smallest(view: View, width_px: int) -> tuple[int, int, int, int]:
    size = 4 * _COARSE_PX
    row = int((90 - view.pitch_deg) / 180 * width_px / 2) - size // 2
    column = int((view.heading_deg / 360 + 0.5) * width_px) - size // 2
    return max(0, min(row, width_px // 2 - size)), size, column % width_px, size


def _span(seen: NDArray[np.bool_]) -> tuple[int, int]:
    """First and number of the shortest run around the circle that holds all that is seen."""
    places = np.flatnonzero(seen)
    gaps = np.diff(np.append(places, places[0] + len(seen)))
    widest = int(np.argmax(gaps))
    first = int(places[(widest + 1) % len(places)])
    return first, len(seen) - int(gaps[widest]) + 1


def _union(spans: Sequence[tuple[int, int]], width_px: int) -> tuple[int, int]:
    seen = np.zeros(width_px, np.bool_)
    for left, width in spans:
        seen[np.arange(left, left + width) % width_px] = True
    return _span(seen)


class _Kept:
    """The maps used last, as many as fit; safe to use from several threads."""

    def __init__(self, limit_bytes: int) -> None:
        self._limit_bytes = limit_bytes
        self._patches: OrderedDict[Any, tuple[Patch, ...]] = OrderedDict()
        self._bytes = 0
        self._lock = Lock()

    def get(self, key: Any, make: Any) -> tuple[Patch, ...]:
        with self._lock:
            if key in self._patches:
                self._patches.move_to_end(key)
                return self._patches[key]
        made: tuple[Patch, ...] = make()
        with self._lock:
            if key not in self._patches:
                self._patches[key] = made
                self._bytes += _bytes(made)
            while self._bytes > self._limit_bytes and len(self._patches) > 1:
                self._bytes -= _bytes(self._patches.popitem(last=False)[1])
        return made


def _bytes(patches: tuple[Patch, ...]) -> int:
    return sum(patch.column.nbytes + patch.row.nbytes for patch in patches)


_kept = _Kept(_CACHE_BYTES)

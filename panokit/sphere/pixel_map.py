"""Where every pixel of one picture lies in another: made once, applied to many pictures.

Making a map costs several times what applying it does, so maps are kept, within a limit of
memory, and found again when the same projections, sizes and rotation return.
"""

from collections import OrderedDict
from dataclasses import dataclass
from functools import cached_property
from threading import Lock
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.sphere.equirect import Equirectangular
from panokit.sphere.extension import extend, locate, pad_sphere
from panokit.sphere.projection import Projection, pixel_grid
from panokit.sphere.spline import BORDER_PX, spline_remap

Interpolation = Literal["nearest", "linear", "spline"]

_CACHE_BYTES = 256 << 20
_STRIP_PIXELS = 1 << 20
# cv2.remap is exact in float32 and uint8; on float64 with borders it writes zeros (5.0.0).
_PICTURE_TYPES = (np.dtype(np.uint8), np.dtype(np.float32))


@dataclass(frozen=True, eq=False, kw_only=True)
class PixelMap:
    """For every pixel of a target picture, its place in a source picture.

    Attributes:
        source: The source's projection.
        source_width_px: The source's size.
        source_height_px: The source's size.
        column: (h, w) float32, in the source with a border of `border_px`.
        row: (h, w) float32.
        valid: (h, w) bool: both pictures show this direction.
        border_px: 0 for equirectangular sources, which need no copy with a border.
    """

    source: Projection
    source_width_px: int
    source_height_px: int
    column: NDArray[np.float32]
    row: NDArray[np.float32]
    valid: NDArray[np.bool_]
    border_px: int

    @cached_property
    def fixed_point(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """The map in steps of 1/32 pixel, which is all that 8-bit pictures can show."""
        row = self.row if self.border_px else self._row_inside
        integer, fraction = cv2.convertMaps(self.column, row, cv2.CV_16SC2)
        return np.asarray(integer), np.asarray(fraction)

    @cached_property
    def _row_inside(self) -> NDArray[np.float32]:
        return np.clip(self.row, 0, self.source_height_px - 1)

    @cached_property
    def across_pole(self) -> tuple[NDArray[np.intp], NDArray[np.float32]]:
        """The target pixels within half a row of a pole, and by how many rows they are beyond."""
        beyond = np.flatnonzero((self.row < 0) | (self.row > self.source_height_px - 1))
        return beyond, np.abs(self.row - self._row_inside).ravel()[beyond]


def pixel_map(
    source: Projection,
    source_size_px: tuple[int, int],
    target: Projection,
    target_size_px: tuple[int, int],
    target_from_source: Rotation | None = None,
) -> PixelMap:
    """Where every pixel of the target lies in the source; kept for the next call.

    Args:
        source: Projection of the picture to read.
        source_size_px: Its width and height.
        target: Projection of the picture to make.
        target_size_px: Its width and height.
        target_from_source: What is at direction d in the source is at
            `target_from_source.apply(d)` in the target.
    """
    rotation = target_from_source or Rotation.identity()
    key = (source, source_size_px, target, target_size_px, rotation)
    kept = _kept.get(key)
    if kept is not None:
        return kept
    width, height = target_size_px
    strip = max(1, _STRIP_PIXELS // max(width, 1))
    parts = []
    for top in range(0, max(height, 1), strip):
        directions, valid = pixel_grid(target, width, height, slice(top, min(top + strip, height)))
        turned = rotation.inverse.apply(directions)
        parts.append(map_directions(turned, source, *source_size_px, valid=valid))
    made = parts[0] if len(parts) == 1 else _stacked(parts)
    _kept.put(key, made)
    return made


def map_directions(
    directions: NDArray[np.floating],
    source: Projection,
    source_width_px: int,
    source_height_px: int,
    *,
    valid: NDArray[np.bool_] | None = None,
) -> PixelMap:
    """Where directions (h, w, 3) lie in a picture; not kept."""
    border = 0 if isinstance(source, Equirectangular) else BORDER_PX
    column, row, inside = locate(directions, source, source_width_px, source_height_px, border)
    return PixelMap(
        source=source,
        source_width_px=source_width_px,
        source_height_px=source_height_px,
        column=np.asarray(column, np.float32),
        row=np.asarray(row, np.float32),
        valid=inside if valid is None else inside & valid,
        border_px=border,
    )


def apply_map(
    picture: NDArray[Any], found: PixelMap, *, interpolation: Interpolation = "linear"
) -> NDArray[Any]:
    """Read a picture through a map.

    Args:
        picture: (H, W) or (H, W, C), uint8 or float32, of the size that the map was made for.
        found: From `pixel_map`.
        interpolation: "linear"; "spline", 25 dB closer to the truth on fine detail and five
            times the time; or "nearest".

    Returns:
        (h, w) or (h, w, C) in the picture's dtype; what lies outside the source repeats its edge.
    """
    if picture.dtype not in _PICTURE_TYPES:
        raise UsageError(f"Pictures to sample are uint8 or float32, not {picture.dtype}.")
    if picture.shape[:2] != (found.source_height_px, found.source_width_px):
        raise UsageError(
            f"The map is for pictures of {found.source_width_px}x{found.source_height_px}, "
            f"not {picture.shape[1]}x{picture.shape[0]}."
        )
    picture = np.asarray(picture)
    if picture.ndim == 3 and picture.shape[2] == 1:
        # OpenCV drops an axis of one channel.
        return apply_map(picture[..., 0], found, interpolation=interpolation)[..., None]
    if interpolation == "spline":
        return _spline(picture, found)
    if found.border_px:
        bordered = extend(picture, found.source, found.border_px)
        return _remap(bordered, found, interpolation, cv2.BORDER_REPLICATE)
    if picture.shape[1] % 2:
        raise UsageError(f"A spherical picture has an even width; this one has {picture.shape[1]}.")
    sampled = _remap(picture, found, interpolation, cv2.BORDER_WRAP)
    if interpolation == "linear" and len(found.across_pole[0]):
        _mix_across_poles(picture, found, sampled)
    return sampled


def _remap(
    picture: NDArray[Any], found: PixelMap, interpolation: Interpolation, border: int
) -> NDArray[Any]:
    row = found.row if found.border_px else found._row_inside
    if interpolation == "nearest":
        return cv2.remap(picture, found.column, row, cv2.INTER_NEAREST, borderMode=border)
    if picture.dtype == np.uint8:
        return cv2.remap(picture, *found.fixed_point, cv2.INTER_LINEAR, borderMode=border)
    return cv2.remap(picture, found.column, row, cv2.INTER_LINEAR, borderMode=border)


def _mix_across_poles(picture: NDArray[Any], found: PixelMap, sampled: NDArray[Any]) -> None:
    # A border would mean a copy of the picture; the few pixels beyond the outermost rows are
    # mixed with what lies across the pole instead, at the opposite azimuth.
    beyond, share = found.across_pole
    column = found.column.ravel()[beyond] + np.float32(found.source_width_px / 2)
    row = found._row_inside.ravel()[beyond]
    wide = 1 << 12
    block = np.zeros((2, -(-len(beyond) // wide) * wide), np.float32)
    block[0, : len(beyond)], block[1, : len(beyond)] = column, row
    across = cv2.remap(
        picture, block[0].reshape(-1, wide), block[1].reshape(-1, wide), cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_WRAP,
    )  # fmt: skip
    flat = sampled.reshape(-1, *sampled.shape[2:])
    across = across.reshape(-1, *sampled.shape[2:])[: len(beyond)]
    share = share.reshape(-1, *(1,) * (flat.ndim - 1))
    mixed = (1 - share) * flat[beyond] + share * across
    flat[beyond] = np.rint(mixed) if sampled.dtype == np.uint8 else mixed


def _spline(picture: NDArray[Any], found: PixelMap) -> NDArray[Any]:
    values = picture.astype(np.float32, copy=False)
    if found.border_px:
        result = spline_remap(extend(values, found.source, BORDER_PX), found.column, found.row)
    else:
        shift = np.float32(BORDER_PX)
        result = spline_remap(
            pad_sphere(values, BORDER_PX), found.column + shift, found.row + shift
        )
    if picture.dtype == np.uint8:
        return np.clip(np.rint(result), 0, 255).astype(np.uint8)
    return result


def _stacked(parts: list[PixelMap]) -> PixelMap:
    first = parts[0]
    return PixelMap(
        source=first.source,
        source_width_px=first.source_width_px,
        source_height_px=first.source_height_px,
        column=np.concatenate([part.column for part in parts]),
        row=np.concatenate([part.row for part in parts]),
        valid=np.concatenate([part.valid for part in parts]),
        border_px=first.border_px,
    )


class _Kept:
    """The maps used last, as many as fit; safe to use from several threads."""

    def __init__(self, limit_bytes: int) -> None:
        self._limit_bytes = limit_bytes
        self._maps: OrderedDict[Any, PixelMap] = OrderedDict()
        self._lock = Lock()

    def get(self, key: object) -> PixelMap | None:
        with self._lock:
            if key not in self._maps:
                return None
            self._maps.move_to_end(key)
            return self._maps[key]

    def put(self, key: object, made: PixelMap) -> None:
        with self._lock:
            self._maps[key] = made
            total = sum(map(_bytes, self._maps.values()))
            while total > self._limit_bytes:
                _, dropped = self._maps.popitem(last=False)
                total -= _bytes(dropped)


def _bytes(found: PixelMap) -> int:
    # Twice the coordinates: the forms derived from them are kept, too.
    return 2 * (found.column.nbytes + found.row.nbytes) + found.valid.nbytes


_kept = _Kept(_CACHE_BYTES)

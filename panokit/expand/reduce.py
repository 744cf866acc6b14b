"""A panorama of any size as linear maps of the size that the result will have.

Clipping is judged on the full-size pixels, before any averaging, so a lamp that is thinner
than a target pixel still counts with its true share. The picture is decoded strip by strip:
memory does not grow with it.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_decode_u8
from panokit.sphere import row_solid_angles
from panokit.sphere.solid_angle import row_overlap_weights

# A pixel is burnt out where its second-highest channel reaches this code. Asking for all
# three misses sodium lamps, asking for any one marks blue skies as lamps.
BURNT_CODE = 250

_STRIP_PIXELS = 1 << 20
_PLANES = 11


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReducedPanorama:
    """A panorama, or some rows of one, split into what the camera could record and what not.

    All maps are means over the solid angle of each target pixel; clear + burnt is the whole
    picture.

    Attributes:
        clear: (H, W, 3) float32, linear, of the pixels that are not burnt out.
        burnt: (H, W, 3) float32, linear, of the pixels that are.
        share: (H, W) float32, how much of the target pixel is burnt out, 0 to 1.
        white: (H, W) float32, how much of it is burnt out in all three channels, 0 to 1.
        encoded: (H, W, 3) float32, display-encoded values in [0, 1].
    """

    clear: NDArray[np.float32]
    burnt: NDArray[np.float32]
    share: NDArray[np.float32]
    white: NDArray[np.float32]
    encoded: NDArray[np.float32]

    @property
    def width_px(self) -> int:
        """Twice the height."""
        return int(self.share.shape[1])

    @property
    def linear(self) -> NDArray[np.float32]:
        """The whole picture, (H, W, 3) float32, linear; 1 is white."""
        return self.clear + self.burnt

    @property
    def burnt_share(self) -> float:
        """The share of the sphere that is burnt out, 0 to 1."""
        weights = row_solid_angles(self.width_px // 2, self.width_px)
        return float(weights @ self.share.sum(axis=1, dtype=np.float64) / (4 * np.pi))

    def at_width(self, width_px: int) -> "ReducedPanorama":
        """The same maps averaged to a smaller width."""
        if width_px == self.width_px:
            return self
        planes = [self.clear, self.burnt, self.share[..., None], self.white[..., None]]
        stack = np.concatenate([*planes, self.encoded], axis=2).transpose(2, 0, 1)
        mix = row_overlap_weights(self.width_px // 2, width_px // 2).astype(np.float32)
        return _from_planes(mix @ _average_columns(np.ascontiguousarray(stack), width_px))


def burnt_out(pixels: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Which pixels (..., 3) lost their light to clipping, (...) bool; see `BURNT_CODE`."""
    red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    second = np.maximum(np.minimum(red, green), np.minimum(np.maximum(red, green), blue))
    return np.asarray(second >= BURNT_CODE)


def reduce_panorama(pixels: NDArray[np.uint8], width_px: int) -> ReducedPanorama:
    """Average a panorama to `width_px` x `width_px // 2`, keeping its energy.

    Args:
        pixels: (H, W, 3) uint8, W == 2 H, W >= width_px.
        width_px: Of the result, even.
    """
    height, width = pixels.shape[:2]
    rows = max(_STRIP_PIXELS // width, 1)
    mix = row_overlap_weights(height, width_px // 2).astype(np.float32)
    total = np.zeros((_PLANES, width_px // 2, width_px), np.float32)
    for top in range(0, height, rows):
        strip = _average_columns(_planes_of(pixels[top : top + rows]), width_px)
        weights = mix[:, top : top + rows]
        targets = np.flatnonzero(weights.any(axis=1))
        first, last = targets[0], targets[-1] + 1
        total[:, first:last] += weights[first:last] @ strip
    return _from_planes(total)


def reduce_rows(pixels: NDArray[np.uint8], width_px: int, first: int, last: int) -> ReducedPanorama:
    """Only the rows `first` to `last` - 1 of what `reduce_panorama` would return."""
    height, width = pixels.shape[:2]
    rows = width_px // 2
    top, bottom = first * height // rows, -(-last * height // rows)
    mix = _row_mix(height, rows, slice(top, bottom), slice(first, last))
    planes = np.zeros((_PLANES, last - first, width_px), np.float32)
    step = max(_STRIP_PIXELS // width, 1)
    for start in range(top, bottom, step):
        end = min(start + step, bottom)
        strip = _average_columns(_planes_of(pixels[start:end]), width_px)
        weights = mix[:, start - top : end - top]
        targets = np.flatnonzero(weights.any(axis=1))
        inside = slice(targets[0], targets[-1] + 1)
        planes[:, inside] += weights[inside] @ strip
    return _from_planes(planes)


def _row_mix(
    source_rows: int, target_rows: int, source: slice, target: slice
) -> NDArray[np.float32]:
    """The part of `row_overlap_weights` between some rows, which together hold all of their
    solid angle; float32.
    """  # noqa: D205
    upper = -np.cos(np.arange(source.start, source.stop + 1) * (np.pi / source_rows))
    lower = -np.cos(np.arange(target.start, target.stop + 1) * (np.pi / target_rows))
    begin = np.maximum(upper[None, :-1], lower[:-1, None])
    end = np.minimum(upper[None, 1:], lower[1:, None])
    shared = np.maximum(end - begin, 0)
    return np.asarray(shared / shared.sum(axis=1, keepdims=True), np.float32)


def _planes_of(pixels: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Everything that is averaged, (11, h, W): clear, burnt, share, white, encoded."""
    planes = np.empty((_PLANES, *pixels.shape[:2]), np.float32)
    channels = pixels.transpose(2, 0, 1)
    linear = srgb_decode_u8(np.ascontiguousarray(channels))
    burnt = burnt_out(pixels)
    planes[3:6] = linear * burnt
    planes[0:3] = linear - planes[3:6]
    planes[6] = burnt
    planes[7] = pixels.min(axis=2) >= BURNT_CODE
    planes[8:11] = channels
    planes[8:11] /= 255
    return planes


def _average_columns(planes: NDArray[np.float32], width_px: int) -> NDArray[np.float32]:
    """(C, h, W) to (C, h, `width_px`): the mean over each new pixel's width."""
    count, height, width = planes.shape
    if width == width_px:
        return planes
    # As one picture of a single channel: OpenCV averages areas of at most four channels.
    lines = planes.reshape(count * height, width)
    narrow = cv2.resize(lines, (width_px, count * height), interpolation=cv2.INTER_AREA)
    return np.asarray(narrow, np.float32).reshape(count, height, width_px)


def _from_planes(planes: NDArray[np.float32]) -> ReducedPanorama:
    maps = np.ascontiguousarray(planes.transpose(1, 2, 0))
    return ReducedPanorama(
        clear=maps[..., 0:3],
        burnt=maps[..., 3:6],
        share=maps[..., 6],
        white=maps[..., 7],
        encoded=maps[..., 8:11],
    )

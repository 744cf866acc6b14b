"""Resize and rotate radiance so that the energy, the sum of L dOmega, stays what it was.

General-purpose resizers change a map's energy by 20 to 100 % when a sun is near a pole, and
point samplers lose a small sun outright; a light probe treated so lights the wrong scene.
"""

from functools import reduce
from typing import Any, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.frames import Frame, Rotation, direction_from_azimuth_elevation
from panokit.sphere.equirect import equirect_pixel
from panokit.sphere.irradiance import energy
from panokit.sphere.pixel_map import Interpolation
from panokit.sphere.sampling import rotate_pixels
from panokit.sphere.solid_angle import row_overlap_weights, row_solid_angles

_Values = TypeVar("_Values", bound=NDArray[Any])


def resize(envmap: EnvironmentMap, width_px: int) -> EnvironmentMap:
    """The map at another size, with the same energy; see `resize_radiance`."""
    return envmap.with_changes(radiance=resize_radiance(envmap.radiance, width_px))


def resize_radiance(
    radiance: NDArray[np.float32], width_px: int, height_px: int | None = None
) -> NDArray[np.float32]:
    """Radiance (H, W, C) resampled to `width_px` x `height_px`, energy kept.

    Smaller: each target pixel is the mean over the solid angle that it covers. Larger:
    linear interpolation, then each source pixel's block is scaled to the energy it had.

    Args:
        radiance: Equirectangular.
        width_px: Even, at least 2.
        height_px: Half the width if not given; another only to make a map smaller, such as
            64x64 anamorphic from 1024x512.

    Raises:
        UsageError: If the new size is not possible.
    """
    radiance = _as_radiance(radiance, "resize")
    height, width = radiance.shape[:2]
    if width_px < 2 or width_px % 2:
        raise UsageError(f"The new width must be even and at least 2, not {width_px}.")
    if height_px is None:
        height_px = width_px // 2
    if (width_px, height_px) == (width, height):
        return radiance
    if width_px <= width and 1 <= height_px <= height:
        return _checked(_average_down(radiance, width_px, height_px))
    if height_px != width_px // 2 or width != 2 * height:
        raise UsageError(
            f"A map of {width}x{height} cannot become {width_px}x{height_px}: only maps twice as "
            "wide as high are made larger."
        )
    return _checked(_interpolate_up(radiance, width_px))


def rotate(
    envmap: EnvironmentMap,
    target_from_source: Rotation,
    *,
    frame: Frame | None = None,
    interpolation: Interpolation = "linear",
) -> EnvironmentMap:
    """The map as it looks in a rotated frame, with the same energy; see `rotate_radiance`.

    Args:
        envmap: The map.
        target_from_source: What was in direction d is in `target_from_source.apply(d)`.
        frame: What the target frame is; unchanged if not given.
        interpolation: As of `rotate_radiance`.
    """
    return envmap.with_changes(
        radiance=rotate_radiance(envmap.radiance, target_from_source, interpolation=interpolation),
        frame=envmap.frame if frame is None else frame,
    )


def rotate_radiance(
    radiance: NDArray[np.float32],
    target_from_source: Rotation,
    *,
    interpolation: Interpolation = "linear",
) -> NDArray[np.float32]:
    """Radiance (H, W, C) as it looks in a rotated frame, energy kept per channel.

    Whole-pixel yaws are an exact roll. Otherwise the few brightest pixels are moved as
    parcels of energy, which is exact however small the source, and the smooth rest is
    interpolated.

    Args:
        radiance: Equirectangular, (H, W, C) with W == 2 H.
        target_from_source: What was in direction d is in `target_from_source.apply(d)`.
        interpolation: Of the smooth rest: "linear", or "spline" to keep fine detail sharp.
    """
    radiance = _as_radiance(radiance, "rotate")
    width = radiance.shape[1]
    shift = _whole_pixel_yaw(target_from_source, width)
    if shift is not None:
        return np.roll(radiance, shift, axis=1)
    _checked(energy(radiance))
    smooth, excess = _split_bright(radiance)
    rotated = rotate_pixels(smooth, target_from_source, interpolation=interpolation)
    before, after = energy(smooth), energy(rotated)
    rotated *= np.divide(before, after, out=np.ones_like(before), where=after > 0).astype(
        np.float32
    )
    _scatter(excess, target_from_source, rotated)
    return rotated


def _as_radiance(radiance: NDArray[Any], what_for: str) -> NDArray[np.float32]:
    if radiance.ndim != 3 or 0 in radiance.shape:
        raise UsageError(f"Radiance to {what_for} is (H, W, C) with pixels, not {radiance.shape}.")
    if not np.issubdtype(radiance.dtype, np.floating):
        raise UsageError(
            f"Radiance to {what_for} is floating point, not {radiance.dtype}: decode display "
            "values with panokit.color.srgb_decode, or read the file with panokit.io."
        )
    return np.asarray(radiance, np.float32)


def _checked(result: _Values) -> _Values:
    # A sum over all pixels shows whether any was not finite, without a look at each.
    if not np.isfinite(result.sum(dtype=np.float64)):
        raise UsageError(
            "The radiance holds values that are not finite. Read the file with repair=True to "
            "clean it knowingly."
        )
    return result


def _average_down(
    radiance: NDArray[np.float32], width_px: int, height_px: int
) -> NDArray[np.float32]:
    height, width, channels = radiance.shape
    weights = row_overlap_weights(height, height_px).astype(np.float32)
    if height % height_px:
        narrow = cv2.resize(radiance, (width_px, height), interpolation=cv2.INTER_AREA)
        rows = weights @ narrow.reshape(height, -1)
        return np.asarray(rows.reshape(height_px, width_px, channels))
    # With a whole number of source rows in each target row the matrix is block diagonal, and
    # summing rows first reads the picture in the order of its memory.
    block = height // height_px
    own = np.stack([weights[t, t * block : (t + 1) * block] for t in range(height_px)])
    rows = np.matmul(own[:, None], radiance.reshape(height_px, block, -1))
    low = rows.reshape(height_px, width, channels)
    return np.asarray(
        cv2.resize(low, (width_px, height_px), interpolation=cv2.INTER_AREA).reshape(
            height_px, width_px, channels
        )
    )


def _interpolate_up(radiance: NDArray[np.float32], width_px: int) -> NDArray[np.float32]:
    height, width = radiance.shape[:2]
    size = (width_px, width_px // 2)
    # Two more columns on either side let the interpolation wrap; they are cut off again.
    margin = 2
    wrapped = np.concatenate([radiance[:, -margin:], radiance, radiance[:, :margin]], axis=1)
    scale = width_px / width
    column = np.arange(width_px, dtype=np.float32)[None, :].repeat(size[1], 0)
    row = np.arange(size[1], dtype=np.float32)[:, None].repeat(width_px, 1)
    larger: NDArray[Any] = cv2.remap(
        wrapped,
        (column + 0.5) / scale - 0.5 + margin,
        np.clip((row + 0.5) / scale - 0.5, 0, height - 1),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REPLICATE,
    )
    if width_px % width:
        before, after = energy(radiance), energy(larger)
        gain = np.divide(before, after, out=np.ones_like(before), where=after > 0)
        return np.asarray(larger * gain, np.float32)
    factor = width_px // width
    blocks = _average_down(larger, width, height)
    correction = np.divide(radiance, blocks, out=np.ones_like(blocks), where=blocks > 0)
    spread = correction.repeat(factor, axis=0).repeat(factor, axis=1)
    return np.asarray(larger * spread, np.float32)


def _whole_pixel_yaw(rotation: Rotation, width: int) -> int | None:
    heading, pitch, roll = rotation.heading_pitch_roll()
    columns = heading / (2 * np.pi) * width
    level = abs(pitch) < 1e-9 and abs(roll) < 1e-9
    return round(columns) if level and abs(columns - round(columns)) < 1e-6 else None


def _split_bright(
    radiance: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The map with its brightest pixels cut to a common level, and what was cut off."""
    peak = reduce(np.maximum, cv2.split(radiance)) if radiance.shape[2] > 1 else radiance[..., 0]
    # A rank over every fourth pixel of every fourth row is near enough.
    some = peak[::4, ::4] if peak.size > 1 << 19 else peak
    level = np.float32(max(16 * float(np.median(some)), float(np.percentile(some, 99)), 1e-30))
    smooth, excess = radiance.copy(), np.zeros_like(radiance)
    bright = peak > level
    smooth[bright] *= (level / peak[bright])[:, None]
    excess[bright] = radiance[bright] - smooth[bright]
    return smooth, excess


def _scatter(
    excess: NDArray[np.float32], target_from_source: Rotation, target: NDArray[np.float32]
) -> None:
    """Add the excess to `target` as parcels of energy, each pixel cut into small parts."""
    height, width, channels = excess.shape
    rows, columns = np.nonzero(reduce(np.logical_or, np.moveaxis(excess, 2, 0)))
    if not len(rows):
        return
    solid_angles = row_solid_angles(height, width)
    parcels = excess[rows, columns] * solid_angles[rows, None]
    centers = direction_from_azimuth_elevation(
        ((columns + 0.5) / width - 0.5) * 2 * np.pi, (0.5 - (rows + 0.5) / height) * np.pi
    )
    _, target_row = equirect_pixel(target_from_source.apply(centers), width, height)
    gathered = np.zeros((channels, height * width))
    # Near the target's poles pixels are narrow slivers, and a source pixel covers many. Two
    # parts a side leave an even patch even to 0.2 %.
    covered = 1 / np.sin(np.pi * (np.clip(target_row, 0, height - 1) + 0.5) / height)
    parts = 2 * 2 ** np.ceil(np.log2(np.clip(covered, 1, 32))).astype(int)
    for count in np.unique(parts):
        chosen = np.flatnonzero(parts == count)
        for some in np.array_split(chosen, max(1, len(chosen) * count**2 // (1 << 22))):
            index, share = _landing(
                rows[some], columns[some], int(count), target_from_source, (height, width)
            )
            for channel in range(channels):
                weights = share * parcels[some, channel, None]
                gathered[channel] += np.bincount(
                    index.ravel(), weights.ravel(), minlength=height * width
                )
    target += (gathered.T.reshape(height, width, channels) / solid_angles[:, None, None]).astype(
        np.float32
    )


def _landing(
    rows: NDArray[np.intp],
    columns: NDArray[np.intp],
    parts: int,
    target_from_source: Rotation,
    shape: tuple[int, int],
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Where the parts of pixels land: (n, k) target pixels, and their shares of the parcel."""
    height, width = shape
    inside = (np.arange(parts) + 0.5) / parts
    azimuth = ((columns[:, None] + inside) / width - 0.5) * 2 * np.pi
    # Parts of equal solid angle: equal steps in the sine of the elevation.
    top = np.cos(np.pi * rows / height)[:, None]
    bottom = np.cos(np.pi * (rows + 1) / height)[:, None]
    height_y = top + (bottom - top) * inside
    horizontal = np.sqrt(np.maximum(1 - height_y**2, 0))
    directions = np.stack(
        np.broadcast_arrays(
            horizontal[:, :, None] * np.sin(azimuth)[:, None, :],
            height_y[:, :, None],
            -horizontal[:, :, None] * np.cos(azimuth)[:, None, :],
        ),
        axis=-1,
    ).reshape(len(rows), -1, 3)
    column, row = equirect_pixel(target_from_source.apply(directions), width, height)
    left, above = np.floor(column).astype(int), np.floor(row).astype(int)
    right_share, below_share = column - left, row - above
    indices, shares = [], []
    for dx, share_x in ((0, 1 - right_share), (1, right_share)):
        for dy, share_y in ((0, 1 - below_share), (1, below_share)):
            near = above + dy
            # Beyond a pole lies the outermost row again, at the opposite azimuth.
            beyond = (near < 0) | (near >= height)
            across = np.where(beyond, width // 2, 0)
            indices.append(np.clip(near, 0, height - 1) * width + (left + dx + across) % width)
            shares.append(share_x * share_y / parts**2)
    return np.concatenate(indices, axis=1), np.concatenate(shares, axis=1)

"""Fill one hole: choose what suits it, make it fit its rim, blend it in."""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.inpaint.face import face_around, paste
from panokit.inpaint.membrane import membrane
from panokit.inpaint.texture import texture
from panokit.sphere import equirect_directions, row_solid_angles

# Up to this radius a hole is a speck, and the lines around it can be drawn through it.
_SPECK = np.deg2rad(1.0)
# Beyond it no flat view shows a hole and its surroundings.
_LARGEST = np.deg2rad(50.0)
# Mean size of the second difference, in gray levels, up to which surroundings are smooth.
_SMOOTH_SKY = 1.2


@dataclass(frozen=True, slots=True)
class Region:
    """A connected hole on the sphere.

    Attributes:
        center: (3,), a direction in its middle.
        radius: The angle from there to its farthest pixel, in radians.
        rows: The rows of the panorama that it and its rim reach.
    """

    center: NDArray[np.float64]
    radius: float
    rows: slice


def region_of(mask: NDArray[np.bool_], rim: float) -> Region:
    """Where a hole is and how large; `rim` is the width of its rim in radians."""
    height, width = mask.shape
    used = np.flatnonzero(mask.any(axis=1))
    band = slice(int(used[0]), int(used[-1]) + 1)
    inside = mask[band]
    directions = equirect_directions(width, height, band)[inside].astype(np.float64)
    share = np.broadcast_to(row_solid_angles(height, width)[band, None], inside.shape)[inside]
    mean = share @ directions
    length = float(np.linalg.norm(mean))
    center = mean / length if length > 1e-9 else directions[0]
    # Half a pixel more, so that the corners of the outermost pixels are in it.
    radius = float(np.arccos(np.clip((directions @ center).min(), -1, 1))) + np.pi / width
    reach = int(np.ceil((rim * 1.5) / np.pi * height)) + 2
    rows = slice(max(0, band.start - reach), min(height, band.stop + reach))
    return Region(center, radius, rows)


def fill_region(
    picture: NDArray[np.uint8],
    hole: NDArray[np.bool_],
    unknown: NDArray[np.bool_],
    rim: float,
    method: str,
) -> dict[str, Any]:
    """Fill one connected hole of the panorama, in place.

    Args:
        picture: (H, W, 3) uint8, writable.
        hole: (H, W) bool, the hole.
        unknown: (H, W) bool, every pixel that may not be copied from, this hole included.
        rim: Width of the band around the hole in which the filling fades out, in radians.
        method: "texture" or "smooth".

    Returns:
        The record: method, where, and how large.
    """
    region = region_of(hole, rim)
    if region.radius > _LARGEST:
        picture[hole] = _whole_sphere(picture, unknown)[hole]
        return _record(region, "membrane")
    face = face_around(region.center, region.radius + rim, picture.shape[1])
    view, hole_share, unknown_share = face.views(picture, _as_bytes(hole), _as_bytes(unknown))
    in_hole, known = hole_share > 0, unknown_share == 0
    rim_px = max(rim * face.px_per_radian, 1.0)
    outside = (~in_hole).astype(np.uint8)
    away_px = np.asarray(
        cv2.distanceTransform(outside, cv2.DIST_L2, cv2.DIST_MASK_PRECISE), np.float32
    )
    filling, used = _filling(view, known, away_px, rim_px, region, method)
    opacity = _fade(np.asarray(1 - away_px / rim_px, np.float32))
    paste(picture, face, filling, opacity, hole, region.rows)
    return _record(region, used)


def _filling(
    view: NDArray[np.uint8],
    known: NDArray[np.bool_],
    away_px: NDArray[np.float32],
    rim_px: float,
    region: Region,
    method: str,
) -> tuple[NDArray[np.float32], str]:
    if region.radius <= _SPECK:
        drawn = cv2.inpaint(view, (~known).astype(np.uint8), 3, cv2.INPAINT_TELEA)
        return drawn.astype(np.float32), "telea"
    # The filling goes on under the rim, so that there is something to fade into.
    fixed = known & (away_px >= rim_px)
    if method == "texture" and _detail(view, known, away_px) > _SMOOTH_SKY:
        copied = texture(view, fixed)
        if copied is not None:
            return copied, "texture"
    return membrane(view.astype(np.float32), fixed), "membrane"


def _detail(
    view: NDArray[np.uint8], known: NDArray[np.bool_], away_px: NDArray[np.float32]
) -> float:
    """How much detail there is around the hole: the mean second difference in gray levels."""
    gray = cv2.cvtColor(view, cv2.COLOR_RGB2GRAY).astype(np.float32)
    nearby = away_px < len(view) / 4
    solid = cv2.erode((known & nearby).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    if not solid.any():
        return 0.0
    return float(np.abs(cv2.Laplacian(gray, cv2.CV_32F))[solid].mean())


def _whole_sphere(picture: NDArray[np.uint8], unknown: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """A smooth filling for holes too large for any view, made in the panorama itself."""
    width = min(picture.shape[1], 1024)
    size = (width, width // 2)
    share = cv2.resize((~unknown).astype(np.float32), size, interpolation=cv2.INTER_AREA)
    known_pixels = picture.astype(np.float32) * (~unknown)[..., None]
    sums = cv2.resize(known_pixels, size, interpolation=cv2.INTER_AREA)
    means = np.asarray(sums / np.maximum(share, 1e-6)[..., None], np.float32)
    smooth = membrane(means, np.asarray(share > 0.5), wraps=True)
    full = (picture.shape[1], picture.shape[0])
    larger = cv2.resize(smooth, full, interpolation=cv2.INTER_LINEAR)
    return np.clip(np.rint(larger), 0, 255).astype(np.uint8)


def _as_bytes(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    return np.asarray(mask * np.uint8(255), np.uint8)


def _fade(level: NDArray[np.float32]) -> NDArray[np.float32]:
    """Zero below 0, one above 1, and a smooth step between (3 t^2 - 2 t^3)."""
    t = np.clip(level, 0, 1)
    return np.asarray(t * t * (3 - 2 * t), np.float32)


def _record(region: Region, method: str) -> dict[str, Any]:
    azimuth = np.rad2deg(np.arctan2(region.center[0], -region.center[2]))
    elevation = np.rad2deg(np.arcsin(np.clip(region.center[1], -1, 1)))
    return {
        "method": method,
        "azimuth_deg": round(float(azimuth), 1),
        "elevation_deg": round(float(elevation), 1),
        "radius_deg": round(float(np.rad2deg(region.radius)), 2),
    }

"""Fill one hole: choose what suits it, make it fit its rim, blend it in."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.inpaint.coding import Coding
from panokit.inpaint.face import Face, face_around, paste
from panokit.inpaint.membrane import membrane
from panokit.inpaint.opencv import OPENCV_METHODS, drawn_by_opencv
from panokit.inpaint.texture import texture
from panokit.sphere import equirect_directions, row_solid_angles
from panokit.sphere.distance import pixel_distance

# Up to this radius a hole is a speck, and the lines around it can be drawn through it.
_SPECK = np.deg2rad(1.0)
# Beyond it no flat view shows a hole and its surroundings.
_LARGEST = np.deg2rad(50.0)
# Mean size of the second difference, in gray levels, up to which surroundings are smooth.
_SMOOTH_SKY = 1.2
# A membrane has no detail: it needs neither a fine view nor a wide one.
_MEMBRANE_PX, _MEMBRANE_REACH = 512, 1.35
_NETWORK_PX = 512

Network = Callable[[NDArray[np.float32], NDArray[np.bool_]], NDArray[np.float32]]


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Filler:
    """How holes are filled.

    Attributes:
        method: "texture", "smooth", "network" or one of OpenCV's.
        rim: Width of the band around a hole in which the filling fades out, in radians.
        network: For "network": a view in gray levels and what of it is a hole -> filled.
    """

    method: str
    rim: float
    network: Network | None = None


def region_of(mask: NDArray[np.bool_], rim: float, rows: slice | None = None) -> Region:
    """Where a hole is and how large.

    Args:
        mask: (H, W) bool.
        rim: The width of its rim in radians.
        rows: Rows outside of which the mask is known to be empty.
    """
    height, width = mask.shape
    first = rows.start if rows else 0
    used = np.flatnonzero(mask[rows or slice(None)].any(axis=1)) + first
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
    around = slice(max(0, band.start - reach), min(height, band.stop + reach))
    return Region(center, radius, around)


def fill_region(
    picture: NDArray[Any],
    hole: NDArray[np.bool_],
    unknown: NDArray[np.bool_],
    region: Region,
    coding: Coding,
    filler: Filler,
) -> dict[str, Any]:
    """Fill one connected hole of the panorama, in place.

    Args:
        picture: (H, W, 3) uint8 or float32, writable.
        hole: (H, W) bool, the hole.
        unknown: (H, W) bool, every pixel that may not be copied from, this hole included.
        region: Where the hole is.
        coding: Between the picture's values and gray levels.
        filler: How.

    Returns:
        The record: method, where, and how large.
    """
    if region.radius > _LARGEST:
        picture[hole] = coding.decode(_whole_sphere(coding.encode(picture), unknown)[hole])
        return _record(region, "membrane")
    face = _face_for(region, filler, picture.shape[1])
    view, hole_share, unknown_share = face.views(picture, _as_bytes(hole), _as_bytes(unknown))
    view = coding.encode(view)
    in_hole, known = hole_share > 0, unknown_share == 0
    rim_px = max(filler.rim * face.px_per_radian, 1.0)
    away_px = pixel_distance(~in_hole)
    filling, used = _filling(view, known, away_px, rim_px, region, filler)
    opacity = _fade(np.asarray(1 - away_px / rim_px, np.float32))
    paste(picture, face, filling, opacity, hole[region.rows], region.rows, coding)
    return _record(region, used)


def _face_for(region: Region, filler: Filler, width_px: int) -> Face:
    radius = region.radius + filler.rim
    if filler.method == "smooth" and region.radius > _SPECK:
        reach = max(_MEMBRANE_REACH, 1 + 2 * filler.rim / radius)
        return face_around(region.center, radius, width_px, reach=reach, largest_px=_MEMBRANE_PX)
    return face_around(region.center, radius, width_px)


def _filling(
    view: NDArray[np.float32],
    known: NDArray[np.bool_],
    away_px: NDArray[np.float32],
    rim_px: float,
    region: Region,
    filler: Filler,
) -> tuple[NDArray[np.float32], str]:
    # The filling goes on under the rim, so that there is something to fade into.
    fixed = known & (away_px >= rim_px)
    if filler.network is not None:
        return _at_size(filler.network, view, fixed, _NETWORK_PX), "network"
    if filler.method in OPENCV_METHODS:
        return drawn_by_opencv(view, fixed, filler.method), filler.method
    if region.radius <= _SPECK:
        return drawn_by_opencv(view, known, "telea"), "telea"
    if filler.method == "texture" and _detail(view, known, away_px) > _SMOOTH_SKY:
        copied = texture(view, fixed)
        if copied is not None:
            return copied, "texture"
    return membrane(view, fixed), "membrane"


def _at_size(
    fill: Network, view: NDArray[np.float32], known: NDArray[np.bool_], size_px: int
) -> NDArray[np.float32]:
    """A view filled at a fixed size, and what was not known of it brought back to its own."""
    own = (len(view), len(view))
    small = cv2.resize(membrane(view, known), (size_px, size_px), interpolation=cv2.INTER_AREA)
    share = cv2.resize(known.astype(np.float32), (size_px, size_px), interpolation=cv2.INTER_AREA)
    filled = fill(np.asarray(small, np.float32), np.asarray(share < 0.999))
    larger = cv2.resize(filled, own, interpolation=cv2.INTER_CUBIC)
    return np.where(known[..., None], view, larger).astype(np.float32)


def _detail(
    view: NDArray[np.float32], known: NDArray[np.bool_], away_px: NDArray[np.float32]
) -> float:
    """How much detail there is around the hole: the mean second difference in gray levels."""
    gray = view.mean(axis=-1)
    nearby = away_px < len(view) / 4
    solid = cv2.erode((known & nearby).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    if not solid.any():
        return 0.0
    return float(np.abs(cv2.Laplacian(gray, cv2.CV_32F))[solid].mean())


def _whole_sphere(picture: NDArray[np.float32], unknown: NDArray[np.bool_]) -> NDArray[np.float32]:
    """A smooth filling for holes too large for any view, made in the panorama itself."""
    width = min(picture.shape[1], 1024)
    size = (width, width // 2)
    share = cv2.resize((~unknown).astype(np.float32), size, interpolation=cv2.INTER_AREA)
    sums = cv2.resize(picture * (~unknown)[..., None], size, interpolation=cv2.INTER_AREA)
    means = np.asarray(sums / np.maximum(share, 1e-6)[..., None], np.float32)
    smooth = membrane(means, np.asarray(share > 0.5), wraps=True)
    full = (picture.shape[1], picture.shape[0])
    return np.asarray(cv2.resize(smooth, full, interpolation=cv2.INTER_LINEAR), np.float32)


def _as_bytes(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    return mask.view(np.uint8) * np.uint8(255)


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

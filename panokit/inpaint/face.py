"""A flat view around a hole, and the way back onto the sphere.

In the equirectangular picture the ground below the camera is smeared over the whole width;
whatever fills it there comes out as a pinwheel. Seen straight on, it is just ground.
"""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.frames import Rotation
from panokit.inpaint.coding import Coding, DisplayCoding
from panokit.sphere import Equirectangular, Perspective, apply_map, pixel_map

# How far the view reaches, as a multiple of the hole: what is copied has to come from there.
REACH = 2.3
_LARGEST_HALF_ANGLE = np.deg2rad(65)
_SMALLEST_HALF_ANGLE = np.deg2rad(4)
LARGEST_PX = 2048
_SMALLEST_PX = 32
# Pixels of the view per pixel of the panorama at its center: enough not to soften it.
_DENSITY = 1.25
_STRIP_PIXELS = 1 << 19


@dataclass(frozen=True, slots=True)
class Face:
    """A square pinhole view of the sphere.

    Attributes:
        sphere_from_face: Its pose.
        fov_deg: From edge to edge.
        size_px: Width and height.
    """

    sphere_from_face: Rotation
    fov_deg: float
    size_px: int

    @property
    def px_per_radian(self) -> float:
        """At its center."""
        return float(self.size_px / (2 * np.tan(np.deg2rad(self.fov_deg) / 2)))

    def views(self, *pictures: NDArray[Any]) -> list[NDArray[Any]]:
        """Pictures of the sphere, (H, W) or (H, W, 3) uint8 or float32, as this view shows them.

        The map from the view to the picture is kept: the next panorama of a batch, with a hole
        of the same size below the camera, finds it made.
        """
        view = Perspective(fov_deg=self.fov_deg, sphere_from_camera=self.sphere_from_face)
        height, width = pictures[0].shape[:2]
        found = pixel_map(Equirectangular(), (width, height), view, (self.size_px, self.size_px))
        return [apply_map(picture, found) for picture in pictures]


def face_around(
    center: NDArray[np.floating],
    radius: float,
    width_px: int,
    *,
    reach: float = REACH,
    largest_px: int = LARGEST_PX,
) -> Face:
    """The view that shows a hole with enough of its surroundings.

    Args:
        center: (3,), the direction to look in.
        radius: Of the hole, in radians.
        width_px: Of the panorama; the view is as fine as it.
        reach: How far it shows the surroundings, as a multiple of the hole.
        largest_px: The view has no more pixels than this on a side.
    """
    reached = np.arctan(reach * np.tan(min(radius, _LARGEST_HALF_ANGLE)))
    half = float(np.clip(reached, _SMALLEST_HALF_ANGLE, _LARGEST_HALF_ANGLE))
    size = _DENSITY * width_px / np.pi * np.tan(half)
    size_px = int(np.clip(size, _SMALLEST_PX, largest_px))
    return Face(_looking_at(center), float(np.rad2deg(2 * half)), size_px)


def _looking_at(center: NDArray[np.floating]) -> Rotation:
    """The pose of a camera that looks at `center` with the horizon level."""
    x, y, z = np.asarray(center, np.float64) / np.linalg.norm(center)
    # Straight up or down the heading is free, and zero will do.
    heading = np.arctan2(x, -z) if np.hypot(x, z) > 1e-3 else 0.0
    return Rotation.from_heading_pitch_roll(float(heading), float(np.arcsin(np.clip(y, -1, 1))))


def paste(
    picture: NDArray[Any],
    face: Face,
    filling: NDArray[np.float32],
    opacity: NDArray[np.float32],
    hole: NDArray[np.bool_],
    rows: slice,
    coding: Coding | None = None,
) -> None:
    """Blend a filled view into the panorama, in place; where the opacity is 0 nothing changes.

    Args:
        picture: (H, W, 3) uint8 or float32, writable.
        face: The view.
        filling: (size, size, 3) float32, in gray levels.
        opacity: (size, size) float32, 0 to 1.
        hole: (rows, W) bool, of these rows; the filling is opaque here, whatever the view's
            opacity says.
        rows: The rows of the panorama that the filling reaches.
        coding: Between gray levels and the picture's values; 8-bit if not given.
    """
    coding = coding or DisplayCoding()
    width = picture.shape[1]
    step = max(1, _STRIP_PIXELS // width)
    for top in range(rows.start, rows.stop, step):
        strip = slice(top, min(top + step, rows.stop))
        column, row, inside = _on_face(face, picture.shape[:2], strip)
        alpha = cv2.remap(opacity, column, row, cv2.INTER_LINEAR, borderValue=0)
        alpha[hole[top - rows.start : strip.stop - rows.start] & inside] = 1
        where = np.nonzero(alpha > 0)
        if not len(where[0]):
            continue
        # Only the pixels that change: beside a small hole they are few.
        color = _read(filling, column[where], row[where])
        share = np.asarray(alpha[where][:, None], np.float32)
        old = picture[strip][where]
        mixed = color if share.min() >= 1 else _mixed(coding.encode(old), color, share)
        picture[strip][where] = coding.decode(mixed)


def _mixed(
    old: NDArray[np.float32], new: NDArray[np.float32], share: NDArray[np.float32]
) -> NDArray[np.float32]:
    return np.asarray(old + (new - old) * share, np.float32)


def _read(
    filling: NDArray[np.float32], column: NDArray[np.float32], row: NDArray[np.float32]
) -> NDArray[np.float32]:
    wide = 1 << 10
    count = len(column)
    block = np.zeros((2, -(-count // wide) * wide), np.float32)
    block[0, :count], block[1, :count] = column, row
    found = cv2.remap(
        filling, block[0].reshape(-1, wide), block[1].reshape(-1, wide), cv2.INTER_CUBIC,
        borderMode=cv2.BORDER_REPLICATE,
    )  # fmt: skip
    return np.asarray(found.reshape(-1, 3)[:count], np.float32)


def _on_face(
    face: Face, shape: tuple[int, ...], rows: slice
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_]]:
    """Where some rows of the panorama lie in the view, and which pixels do; -9 for the others.

    A direction is a sum of three products of something of its row and something of its
    column, and so is what a rotation makes of it: nine products of short vectors.
    """
    height, width = shape
    azimuth = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    elevation = (0.5 - (np.arange(rows.start, rows.stop) + 0.5) / height) * np.pi
    level, up = np.cos(elevation)[:, None], np.sin(elevation)[:, None]
    across = np.stack([np.sin(azimuth), np.zeros(width), -np.cos(azimuth)])
    turned = face.sphere_from_face.inverse.matrix
    parts = [(level * (axis @ across)[None] + up * axis[1]).astype(np.float32) for axis in turned]
    depth = -parts[2]
    inside = depth > np.float32(1e-3)
    scale = np.float32(face.px_per_radian) / np.where(inside, depth, 1)
    middle = np.float32(face.size_px / 2 - 0.5)
    column, row = middle + parts[0] * scale, middle - parts[1] * scale
    edge = np.float32(face.size_px - 0.5)
    inside &= (column > -0.5) & (column < edge) & (row > -0.5) & (row < edge)
    # Far outside the view the coordinates may overflow what remap can take.
    column, row = np.where(inside, column, -9), np.where(inside, row, -9)
    return column.astype(np.float32), row.astype(np.float32), inside

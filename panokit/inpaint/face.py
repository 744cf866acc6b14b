"""A flat view around a hole, and the way back onto the sphere.

In the equirectangular picture the ground below the camera is smeared over the whole width;
whatever fills it there comes out as a pinwheel. Seen straight on, it is just ground.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.frames import Rotation
from panokit.sphere import equirect_directions, perspective_directions, sample
from panokit.sphere.perspective import perspective_pixel

# How far the view reaches, as a multiple of the hole: what is copied has to come from there.
_REACH = 2.3
_LARGEST_HALF_ANGLE = np.deg2rad(65)
_SMALLEST_HALF_ANGLE = np.deg2rad(4)
_LARGEST_PX = 2048
_SMALLEST_PX = 32
# Pixels of the view per pixel of the panorama at its center: enough not to soften it.
_DENSITY = 1.25
_STRIP_PIXELS = 1 << 20


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

    def views(self, *pictures: NDArray[np.uint8]) -> list[NDArray[np.uint8]]:
        """Pictures of the sphere, (H, W) or (H, W, 3) uint8, as this view shows them."""
        directions = perspective_directions(
            self.size_px, self.size_px, self.fov_deg, self.sphere_from_face
        )
        return [np.asarray(sample(picture, directions), np.uint8) for picture in pictures]


def face_around(center: NDArray[np.floating], radius: float, width_px: int) -> Face:
    """The view that shows a hole with enough of its surroundings.

    Args:
        center: (3,), the direction to look in.
        radius: Of the hole, in radians.
        width_px: Of the panorama; the view is as fine as it.
    """
    reach = np.arctan(_REACH * np.tan(min(radius, _LARGEST_HALF_ANGLE)))
    half = float(np.clip(reach, _SMALLEST_HALF_ANGLE, _LARGEST_HALF_ANGLE))
    size = _DENSITY * width_px / np.pi * np.tan(half)
    size_px = int(np.clip(size, _SMALLEST_PX, _LARGEST_PX))
    return Face(_looking_at(center), float(np.rad2deg(2 * half)), size_px)


def _looking_at(center: NDArray[np.floating]) -> Rotation:
    """The pose of a camera that looks at `center` with the horizon level."""
    x, y, z = np.asarray(center, np.float64) / np.linalg.norm(center)
    # Straight up or down the heading is free, and zero will do.
    heading = np.arctan2(x, -z) if np.hypot(x, z) > 1e-3 else 0.0
    return Rotation.from_heading_pitch_roll(float(heading), float(np.arcsin(np.clip(y, -1, 1))))


def paste(
    picture: NDArray[np.uint8],
    face: Face,
    filling: NDArray[np.float32],
    opacity: NDArray[np.float32],
    hole: NDArray[np.bool_],
    rows: slice,
) -> None:
    """Blend a filled view into the panorama, in place; where the opacity is 0 nothing changes.

    Args:
        picture: (H, W, 3) uint8, writable.
        face: The view.
        filling: (size, size, 3) float32, 0 to 255.
        opacity: (size, size) float32, 0 to 1.
        hole: (H, W) bool; the filling is opaque here, whatever the view's opacity says.
        rows: The rows of the panorama that the filling reaches.
    """
    height, width = picture.shape[:2]
    step = max(1, _STRIP_PIXELS // width)
    for top in range(rows.start, rows.stop, step):
        strip = slice(top, min(top + step, rows.stop))
        directions = equirect_directions(width, height, strip)
        column, row, inside = perspective_pixel(
            directions, face.size_px, face.size_px, face.fov_deg, face.sphere_from_face
        )
        # Far outside the view the coordinates may overflow what remap can take.
        column = np.where(inside, column, -9).astype(np.float32)
        row = np.where(inside, row, -9).astype(np.float32)
        alpha = cv2.remap(opacity, column, row, cv2.INTER_LINEAR, borderValue=0)
        alpha[hole[strip] & inside] = 1
        where = alpha > 0
        if not where.any():
            continue
        color = cv2.remap(filling, column, row, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
        old = picture[strip][where].astype(np.float32)
        blended = old + (color[where] - old) * alpha[where, None]
        picture[strip][where] = np.clip(np.rint(blended), 0, 255).astype(np.uint8)

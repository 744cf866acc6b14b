"""The pair of cameras: two equal pinhole cameras, side by side, that look at the object.

The cameras are parallel, with a fixed distance between them and equal intrinsics, as in the
2018 thesis; pictures of such cameras are rectified as they are. With toe-in each looks at the
object's center instead; with horizontal image translation parallel cameras shift their
pictures until the center has no disparity.
"""

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.scene import View
from panokit.dataset.settings import RigSettings
from panokit.errors import ImageError
from panokit.frames import Rotation

# The object keeps this share of the picture away from the edges of both views.
_MARGIN = 0.02
_NEAREST_M = 0.3
_FARTHEST_M = 200.0


def place_rig(
    settings: RigSettings,
    points: NDArray[np.floating],
    *,
    baseline_m: float,
    fill: float,
    pitch_deg: float,
    roll_deg: float,
) -> tuple[View, View]:
    """The left and the right camera, at the distance at which the object fills its share.

    The middle of the two looks at the center of the object's bounds, northward before pitch.

    Args:
        settings: Size, field of view, toe-in and translation.
        points: (N, 3), the object's vertices in the world.
        baseline_m: Between the cameras.
        fill: The share of the picture that the object spans, in width or height, whichever is
            more; less where else it would leave one of the pictures.
        pitch_deg: Positive looks up.
        roll_deg: Positive leans to the right.

    Raises:
        ImageError: If the object fits at no distance.
    """
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    corners = np.asarray(points, np.float64)
    world_from_rig = Rotation.from_heading_pitch_roll(
        0.0, float(np.deg2rad(pitch_deg)), float(np.deg2rad(roll_deg))
    )

    def pair(distance: float) -> tuple[View, View]:
        return _pair(settings, world_from_rig, center, distance, baseline_m)

    def is_far_enough(distance: float) -> bool:
        return _fits(pair(distance), corners, fill)

    # In front of the nearest vertex; the object then only becomes smaller with the distance.
    depth = (points - center) @ world_from_rig.matrix[:, 2]
    near, far = float(depth.max()) + _NEAREST_M, _FARTHEST_M
    if not is_far_enough(far):
        raise ImageError(
            "The object is too large for the cameras. Scale it to about a meter.",
            reason="too-large",
        )
    if is_far_enough(near):
        return pair(near)
    # Halving the range of the log so often leaves a thousandth.
    for _ in range(14):
        middle = float(np.sqrt(near * far))
        near, far = (near, middle) if is_far_enough(middle) else (middle, far)
    return pair(far)


def _pair(
    settings: RigSettings,
    world_from_rig: Rotation,
    center: NDArray[np.floating],
    distance: float,
    baseline_m: float,
) -> tuple[View, View]:
    right_axis, back = world_from_rig.matrix[:, 0], world_from_rig.matrix[:, 2]
    half = baseline_m / 2
    turn = float(np.arctan2(half, distance)) if settings.toe_in else 0.0
    focal_px = settings.width_px / 2 / np.tan(np.deg2rad(settings.fov_deg) / 2)
    shift = float(focal_px * half / distance) if settings.translate else 0.0
    views = []
    for name, side in (("left", -1.0), ("right", 1.0)):
        # Toe-in turns the left camera to the right, about the rig's own vertical.
        toed = Rotation.about_axis((0, 1, 0), side * turn)
        position = center + back * distance + right_axis * (side * half)
        views.append(
            View(
                name=name,
                position=(float(position[0]), float(position[1]), float(position[2])),
                world_from_camera=world_from_rig @ toed,
                fov_deg=settings.fov_deg,
                width_px=settings.width_px,
                height_px=settings.width_px,
                shift_px=side * shift,
            )
        )
    return views[0], views[1]


def _fits(views: tuple[View, View], points: NDArray[np.float64], fill: float) -> bool:
    for view in views:
        column, row, depth = view.project(points)
        if depth.min() <= 0:
            return False
        size = view.width_px
        edge = _MARGIN * size
        if column.min() < edge or column.max() > size - edge:
            return False
        if row.min() < edge or row.max() > size - edge:
            return False
        if max(np.ptp(column), np.ptp(row)) > fill * size:
            return False
    return True

"""Two frames of a video become the two views that a network was trained on.

The network knows one kind of camera: it looks at the object, 40 degrees wide, and has a twin a
fifth of the object's size to its right. Out of two frames of a camera that moved sideways that
becomes as follows.

* One virtual camera, turned toward the middle between the object's two places and as narrow as
  makes the object fill the picture, crops *both* frames. It is never centered anew: how far the
  object moved between the frames is the disparity that tells the network of shape.
* Where the object moved up or down a little, the second crop follows: twins have the same height.
* A scene made larger as a whole looks the same. So the object counts as a meter large, as all
  objects of the training data were, and the cameras as 0.2 m apart when it moved by a fifth of
  its larger side.
* The view in which the object is farther right is the left one.
* A narrower view than 40 degrees flattens perspective a little; nothing is done about that.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from panokit.errors import ImageError, UsageError
from panokit.frames import Rotation
from panokit.lighting.crop import camera_for
from panokit.lighting.select import Selection
from panokit.lighting.settings import SnapshotSettings
from panokit.lighting.video import Picture
from panokit.stereo import Views

# Of the shift that networks know.
_LEAST_SHIFT, _MOST_SHIFT = 0.5, 2.0
# Up or down in parts of the object's size, and of size as a ratio.
_MOST_UP, _MOST_SCALE = 0.06, 1.12
# A background that shares more of the object's motion was panned over.
_TURNED = 0.6
# Motion is looked for at this width, at corners of at least that quality (OpenCV's).
_MOTION_PX, _CLEAR = 320, 0.05


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Snapshot:
    """A frame with the object in it.

    Attributes:
        number: Of the frame.
        picture: (H, W, 3) uint8 RGB.
        selection: The object.
    """

    number: int
    picture: Picture
    selection: Selection


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StereoPair:
    """Two snapshots as views.

    Attributes:
        views: What a network looks at.
        left, right: The snapshots, by where the camera was.
        video_from_view: From the frame of the virtual camera to that of the video's.
        shift: How far the object moved, in parts of its larger side.
        warnings: What to mind, a sentence each.
    """

    views: Views
    left: Snapshot
    right: Snapshot
    video_from_view: Rotation
    shift: float
    warnings: tuple[str, ...]


def stereo_pair(
    first: Snapshot, second: Snapshot, settings: SnapshotSettings | None = None
) -> StereoPair:
    """The views of two snapshots, in any order; see the module.

    Raises:
        UsageError: If the frames differ in size.
        ImageError: If there is no object in one of them.
    """
    settings = settings or SnapshotSettings()
    if first.picture.shape != second.picture.shape:
        raise UsageError("The two snapshots differ in size. Take both from one video.")
    for one in (first, second):
        if one.selection.mask.shape != one.picture.shape[:2] or not one.selection.mask.any():
            raise ImageError(f"There is no object in frame {one.number}.", reason="no-object")
    left, right = sorted((first, second), key=lambda one: one.selection.box.center[0], reverse=True)
    boxes = [one.selection.box for one in (left, right)]
    height, width = left.picture.shape[:2]
    camera = camera_for((width, height), boxes[0], boxes[1], settings)
    crops = [
        camera.see(one.picture, one.selection.mask, one.selection.box.center[1])
        for one in (left, right)
    ]
    return StereoPair(
        views=camera.views(crops[0], crops[1], settings.blur), left=left, right=right,
        video_from_view=camera.video_from_view, shift=camera.shift,
        warnings=tuple(_warnings(left, right, camera.shift)),
    )  # fmt: skip


def turned_share(left: Snapshot, right: Snapshot) -> float | None:
    """How much of the object's motion the background shares: 0 where the camera only moved.

    A camera that turns moves all of the picture alike, and shows the object from one place only.

    Returns:
        The background's motion over the object's; None where it has too little detail to tell.
    """
    scale = _MOTION_PX / left.picture.shape[1]
    grays, masks = [], []
    for one in (left, right):
        gray = cv2.cvtColor(one.picture, cv2.COLOR_RGB2GRAY)
        size = (_MOTION_PX, max(16, round(gray.shape[0] * scale)))
        grays.append(np.asarray(cv2.resize(gray, size, interpolation=cv2.INTER_AREA), np.uint8))
        mask = cv2.resize(one.selection.mask.astype(np.uint8), size)
        masks.append(cv2.dilate(mask, np.ones((15, 15), np.uint8)))
    free = (masks[0] == 0).astype(np.uint8)
    corners = cv2.goodFeaturesToTrack(grays[0], 200, _CLEAR, 6, mask=free)
    moved = (left.selection.box.center[0] - right.selection.box.center[0]) * scale
    if corners is None or len(corners) < 8 or abs(moved) < 1:
        return None
    guess = corners - np.array([[moved, 0]], np.float32)
    shifts = []
    for start in (corners, guess):
        # A search from rest finds small motion, one from the object's motion finds that.
        found, status, error = cv2.calcOpticalFlowPyrLK(
            grays[0], grays[1], corners, start.copy(), flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
            winSize=(15, 15), maxLevel=2,
        )  # fmt: skip
        good = (status.ravel() > 0) & (error.ravel() < 12)
        if good.sum() >= 8:
            along = (corners - found)[good].reshape(-1, 2)[:, 0]
            shifts.append((float(np.median(error.ravel()[good])), float(np.median(along))))
    return min(shifts)[1] / moved if shifts else None


def _warnings(left: Snapshot, right: Snapshot, shift: float) -> list[str]:
    found = []
    boxes = [one.selection.box for one in (left, right)]
    if any(one.selection.touches_edge for one in (left, right)):
        found.append("The object touches the frame's edge; take frames that show it whole.")
    up = abs(boxes[0].center[1] - boxes[1].center[1]) / boxes[0].longest
    if up > _MOST_UP:
        found.append(
            f"The object moved up or down by {up:.0%} of its size; keep the camera's height."
        )
    ratio = boxes[0].longest / boxes[1].longest
    if max(ratio, 1 / ratio) > _MOST_SCALE:
        found.append(
            f"The object changed its size by {max(ratio, 1 / ratio) - 1:.0%}; keep the distance."
        )
    usual = SnapshotSettings().shift
    if not _LEAST_SHIFT * usual <= shift <= _MOST_SHIFT * usual:
        found.append(
            f"The object moved sideways by {shift:.0%} of its size between the views; "
            f"networks know {usual:.0%}."
        )
    share = turned_share(left, right)
    if share is not None and share > _TURNED:
        found.append(
            "The background moved with the object: the camera turned instead of moving sideways, "
            "and both views show the object from one place."
        )
    return found

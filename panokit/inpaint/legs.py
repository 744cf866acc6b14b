"""Find what a cap stands on: the legs of a tripod, dark wedges out from below its plate.

Filling only the plate would leave three legs lying on the ground. In the picture unrolled
around the point below the camera they are upright and end; shadows slant or go on, and the
joints of a pavement are thin.
"""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects, label, median_filter

from panokit.inpaint.unroll import COLUMNS, ROW_DEG, rolled_up, unrolled

# In radii of the plate: what ends nearer to it is too short for a leg, what goes on farther
# is none.
_SHORTEST, _REACH = 1.5, 2.2
_NARROWEST_DEG, _WIDEST_DEG = 5.0, 20.0
_FEWEST, _MOST = 2, 4
# How much darker than the ground beside them, as a share of its color, and at least.
_DARKER_SHARE = 0.2
_DARKER = 6.0
# What is thinner in azimuth or shorter along the angle is a joint or a stone.
_THIN_DEG, _SHORT_DEG = 2.5, 2.1
_GROUND_DEG = 62.0
_MARGIN_DEG, _MARGIN_AROUND_DEG = 1.0, 1.75
_EVERY = 8


def find_legs(
    pixels: NDArray[np.uint8], center: NDArray[np.floating], radius_deg: float
) -> tuple[NDArray[np.bool_], int]:
    """The legs around a cap, with a little margin, and their number; none if fewer than two.

    Args:
        pixels: (H, W, 3) uint8, equirectangular.
        center: (3,), the middle of the cap.
        radius_deg: Of the cap.

    Returns:
        (H, W) bool, and how many there are.
    """
    height, width = pixels.shape[:2]
    first = round(radius_deg / ROW_DEG)
    ring = unrolled(pixels, center)[first : round(_REACH * radius_deg / ROW_DEG)]
    legs, count = _legs(_darker(ring), round((_SHORTEST - 1) * first))
    if not _FEWEST <= count <= _MOST:
        return np.zeros((height, width), np.bool_), 0
    rows, columns = round(_MARGIN_DEG / ROW_DEG), round(_MARGIN_AROUND_DEG * COLUMNS / 360)
    wrapped = np.pad(legs, ((0, 0), (columns, columns)), mode="wrap").astype(np.uint8)
    kernel = np.ones((2 * rows + 1, 2 * columns + 1), np.uint8)
    wider = cv2.dilate(wrapped, kernel)[:, columns:-columns] > 0
    # From within the cap on, so that the two are one hole.
    below = np.repeat(wider[:1], first, axis=0)
    return rolled_up(np.concatenate([below, wider]), center, width, height), count


def _darker(ring: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Where it is plainly darker than the ground to both sides, (rows, COLUMNS) bool."""
    soft = cv2.blur(ring, (3, 9))
    # The ground beside: a median far wider than a leg, on few columns because it is slow.
    few = soft[:, ::_EVERY]
    reach = round(_GROUND_DEG / 2 / 360 * COLUMNS / _EVERY)
    wrapped = np.pad(few, ((0, 0), (reach, reach), (0, 0)), mode="wrap")
    ground = median_filter(wrapped, size=(1, 2 * reach + 1, 1))[:, reach:-reach]
    ground = np.repeat(ground, _EVERY, axis=1)
    step = np.linalg.norm(soft - ground, axis=-1)
    least = np.maximum(_DARKER, _DARKER_SHARE * np.linalg.norm(ground, axis=-1))
    return np.asarray((step > least) & (soft.sum(axis=-1) < ground.sum(axis=-1)))


def _legs(dark: NDArray[np.bool_], shortest: int) -> tuple[NDArray[np.bool_], int]:
    """The upright pieces, `shortest` rows or more, that start at the cap and end.

    Returns:
        (rows, COLUMNS) bool, and their number.
    """
    per_deg = COLUMNS / 360
    tall, thin = round(_SHORT_DEG / ROW_DEG), round(_THIN_DEG * per_deg)
    turn = COLUMNS // 4
    # Once around and a quarter more at both ends, so that no piece is cut by where it starts;
    # and the first row repeated, so that what starts there counts as tall.
    wrapped = np.pad(dark, ((0, 0), (turn, turn)), mode="wrap")
    wrapped = np.pad(wrapped, ((tall, 0), (0, 0)), mode="edge")
    solid = cv2.morphologyEx(
        wrapped.astype(np.uint8), cv2.MORPH_OPEN, np.ones((tall, thin), np.uint8)
    )[tall:]
    labels, _ = label(solid)
    legs, count = np.zeros_like(dark), 0
    for index, box in enumerate(find_objects(labels), 1):
        piece = labels[box] == index
        width_deg = piece.sum(axis=1) / per_deg
        middle = (box[1].start + box[1].stop) // 2 - turn
        starts, ends = box[0].start == 0, box[0].stop < len(dark)
        long = box[0].stop >= shortest
        upright = width_deg[0] >= _NARROWEST_DEG and width_deg.max() <= _WIDEST_DEG
        if starts and ends and long and upright and 0 <= middle < COLUMNS:
            row, column = np.nonzero(piece)
            legs[row + box[0].start, (column + box[1].start - turn) % COLUMNS] = True
            count += 1
    return legs, count

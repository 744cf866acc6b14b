"""Whether two views are what a network was trained for: sentences about what is not.

The network assumes one object, seen whole, of one material, in light that does not change, by two
cameras side by side. Nobody's camera does all that; it helps to know what it did not.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance, srgb_decode_u8
from panokit.stereo import Views

# Of the picture.
_LEAST_MASK = 0.02
# Code values, and the most of the object that may have them.
_BURNT, _MOST_BURNT = 250, 0.4
_DARK, _MOST_DARK = 12, 0.8
# Sideways and up or down, of the picture's width; of size and of brightness, as ratios.
_LEAST_DISPARITY, _MOST_ROWS = 0.004, 0.04
_MOST_SCALE, _MOST_CHANGE = 1.1, 1.3


def view_warnings(views: Views) -> tuple[str, ...]:
    """What of the assumptions is not met, a sentence each with what to do about it."""
    return tuple(_warnings(views))


def _warnings(views: Views) -> Iterator[str]:
    left, right = views.mask, np.asarray(views.right_object.any(axis=-1))
    share = float(left.mean())
    if share == 0 or not right.any():
        yield "There is no object in one of the views: nothing but the background was read."
        return
    if share < _LEAST_MASK:
        yield (
            f"The object covers {share:.1%} of the left view; go nearer, {_LEAST_MASK:.0%} is "
            "little already."
        )
    if any(edge.any() for edge in (left[0], left[-1], left[:, 0], left[:, -1])):
        yield "The object touches the picture's edge; take views that show it whole."
    values = views.left_object[left]
    burnt = float((values.max(axis=1) >= _BURNT).mean())
    if burnt > _MOST_BURNT:
        yield f"{burnt:.0%} of the object is burnt out; expose shorter."
    dark = float((values.max(axis=1) <= _DARK).mean())
    if dark > _MOST_DARK:
        yield f"{dark:.0%} of the object is black; expose longer, or take a lighter object."
    yield from _between(views, left, right)
    if not views.background.any():
        yield "Nothing is known of the background, which tells much of the light."


def _between(views: Views, left: NDArray[np.bool_], right: NDArray[np.bool_]) -> Iterator[str]:
    size = left.shape[0]
    boxes = [_box(one) for one in (left, right)]
    (top, bottom, x), (other_top, other_bottom, other_x) = boxes
    same = np.array_equal(views.left_object, views.right_object)
    if same or abs(x - other_x) < _LEAST_DISPARITY * size:
        yield "The object is in the same place in both views: move the camera sideways."
    if abs((top + bottom) - (other_top + other_bottom)) / 2 > _MOST_ROWS * size:
        yield "The object moved up or down between the views: keep the camera's height."
    tall, other = bottom - top + 1, other_bottom - other_top + 1
    if max(tall / other, other / tall) > _MOST_SCALE:
        yield "The object changed its size between the views: keep the distance."
    bright = [
        float(luminance(srgb_decode_u8(picture[seen])).mean())
        for picture, seen in ((views.left_object, left), (views.right_object, right))
    ]
    if max(bright) > _MOST_CHANGE * max(min(bright), 1e-6):
        yield "The object's brightness changed between the views: fix exposure and light."


def _box(mask: NDArray[np.bool_]) -> tuple[int, int, float]:
    """First row, last row and the mean column of a mask that is not empty."""
    rows, columns = np.nonzero(mask)
    return int(rows.min()), int(rows.max()), float(columns.mean())

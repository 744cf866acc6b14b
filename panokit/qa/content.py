"""Figures about what the picture shows: sharp detail, holes, empty areas."""

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.qa.measurements import Finding, Measurements, absent
from panokit.sphere import row_solid_angles

# The finest detail that a picture can hold, and detail twice as coarse.
_FINEST = np.array([1, -4, 6, -4, 1], np.float32) / np.float32(16)
_COARSER = np.array([-1, 0, 2, 0, -1], np.float32) / np.float32(4)
# Where detail is fainter than this many stops there is only noise; where it is stronger, an edge
# between light and dark says more of the scene than of the picture.
_CONTRAST_STOPS = (0.01, 0.25)
_WINDOW_PX = 5
# With less of the picture fit to be looked at, nothing is said.
_LEAST_SHARE = 0.2
# A picture without any edge of this many stops, in its sharpest hundredth, is of a bare sky.
_EDGE_STOPS, _EDGE_QUANTILE = 0.1, 0.99
_LEAST_WIDTH_PX = 256
_MOST_COLUMNS = 1024


def sharpness(measured: Measurements) -> Finding:
    """The strength of the finest detail over that of detail twice as coarse.

    About 0.45 to 0.6 in a sharp picture, less than 0.3 in one that was enlarged from half its
    size: whatever the filter, it cannot invent the finest detail. Measured on log luminance
    in places of little contrast, where it does not matter on which scale the picture was
    enlarged, along rows near the horizon and along columns; the sharper direction counts.
    """
    if measured.width_px < _LEAST_WIDTH_PX:
        return absent(f"narrower than {_LEAST_WIDTH_PX} pixels")
    stops = measured.stops
    height, width = stops.shape
    columns = min(width, max(_MOST_COLUMNS, width // 4))
    along = _ratio(stops[height // 4 : height // 4 * 3, :columns], _FINEST[None], _COARSER[None])
    down = _ratio(
        stops[height // 8 : height // 8 * 7, : columns // 2],
        _FINEST[:, None],
        _COARSER[:, None],
    )
    found = [ratio for ratio in (along, down) if ratio is not None]
    if not found:
        return absent("too little fine detail to tell")
    return Finding(value=max(found))


def _ratio(
    picture: NDArray[np.float32], finest: NDArray[np.float32], coarser: NDArray[np.float32]
) -> float | None:
    window = (_WINDOW_PX, _WINDOW_PX)
    edges = np.abs(cv2.filter2D(picture, -1, coarser))
    if np.quantile(edges[::4, ::4], _EDGE_QUANTILE) < _EDGE_STOPS:
        return None
    coarse = cv2.blur(edges, window)[::2, ::2]
    fine = cv2.blur(np.abs(cv2.filter2D(picture, -1, finest)), window)[::2, ::2]
    fit = (coarse > _CONTRAST_STOPS[0]) & (coarse < _CONTRAST_STOPS[1])
    if fit.mean() < _LEAST_SHARE:
        return None
    return float(np.median(fine[fit] / coarse[fit]))


def empty_area(measured: Measurements) -> Finding:
    """The share of the sphere, in percent, that is exactly black in every channel."""
    empty = measured.luminance <= 0
    covered = empty.sum(axis=1) @ row_solid_angles(measured.envmap.height_px)
    return Finding(value=float(covered) / (4 * np.pi) * 100)


def hole_area(measured: Measurements) -> Finding:
    """The share of the sphere, in percent, of the holes that were found and not filled."""
    return _holes(measured, filled=False)


def filled_area(measured: Measurements) -> Finding:
    """The share of the sphere, in percent, that was made up to fill holes."""
    return _holes(measured, filled=True)


def _holes(measured: Measurements, *, filled: bool) -> Finding:
    step = measured.step("inpaint")
    if step is None:
        return absent("no record of looking for holes")
    try:
        holes = [hole for hole in step.values["holes"] if bool(hole["filled"]) is filled]
        covered = sum(float(hole["solid_angle_sr"]) for hole in holes)
    except (KeyError, TypeError, ValueError):
        return absent("the record of the holes is not one that panokit writes")
    kinds = sorted({str(hole.get("kind", "")) for hole in holes})
    return Finding(value=100 * covered / (4 * np.pi), note=", ".join(k for k in kinds if k))

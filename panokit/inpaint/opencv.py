"""OpenCV's own fillings, in the same flat view as ours: to choose, and to compare with.

They see 8 bits: an HDR map's logarithm, rounded to gray levels and cut at 255.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

OPENCV_METHODS = ("telea", "navier-stokes", "shift-map", "fsr")
_RADIUS_PX = 5
_SEED = 20260101
# Their time grows with the square of the view's area; at these sizes it is seconds.
_SHIFT_MAP_PX, _FSR_PX = 224, 160


def drawn_by_opencv(
    view: NDArray[np.float32], known: NDArray[np.bool_], method: str
) -> NDArray[np.float32]:
    """The view with its unknown pixels filled by OpenCV; the known ones as they are.

    Args:
        view: (N, N, 3) float32, in gray levels.
        known: (N, N) bool.
        method: One of `OPENCV_METHODS`: Telea 2004, Bertalmio et al. 2001, the shift map of
            He & Sun 2012, or frequency-selective reconstruction (Seiler & Kaup 2010).
    """
    size = len(view)
    limit = {"shift-map": _SHIFT_MAP_PX, "fsr": _FSR_PX}.get(method, size)
    small, known_small = view, known
    if size > limit:
        shape = (limit, limit)
        small = np.asarray(cv2.resize(view, shape, interpolation=cv2.INTER_AREA), np.float32)
        share = cv2.resize(known.astype(np.float32), shape, interpolation=cv2.INTER_AREA)
        known_small = np.asarray(share > 0.999)
    filled = _drawn(np.clip(np.rint(small), 0, 255).astype(np.uint8), known_small, method)
    result = filled.astype(np.float32)
    if size > limit:
        result = np.asarray(cv2.resize(result, (size, size), interpolation=cv2.INTER_CUBIC))
    return np.where(known[..., None], view, result).astype(np.float32)


def _drawn(picture: NDArray[np.uint8], known: NDArray[np.bool_], method: str) -> NDArray[np.uint8]:
    unknown = (~known).astype(np.uint8)
    if method == "telea":
        return np.asarray(cv2.inpaint(picture, unknown, _RADIUS_PX, cv2.INPAINT_TELEA), np.uint8)
    if method == "navier-stokes":
        return np.asarray(cv2.inpaint(picture, unknown, _RADIUS_PX, cv2.INPAINT_NS), np.uint8)
    # These two want 255 where the picture is known.
    mask = np.where(known, 255, 0).astype(np.uint8)
    covered = picture * known[..., None]
    if method == "fsr":
        result = np.zeros_like(picture)
        cv2.xphoto.inpaint(covered, mask, result, cv2.xphoto.INPAINT_FSR_FAST)
        return result
    coded = cv2.cvtColor(covered, cv2.COLOR_RGB2LAB)
    coded[~known] = 0
    result = np.zeros_like(coded)
    # Its search is randomized; the same seed gives the same filling.
    cv2.setRNGSeed(_SEED)
    cv2.xphoto.inpaint(coded, mask, result, cv2.xphoto.INPAINT_SHIFTMAP)
    return np.asarray(cv2.cvtColor(result, cv2.COLOR_LAB2RGB), np.uint8)

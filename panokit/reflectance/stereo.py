"""Depth and normals from two parallel views, by classical block matching."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.errors import UsageError
from panokit.reflectance.normals import normals_from_depth

_BLOCK_PX = 5
_ENLARGED = 2
# Numbers of disparities are multiples of this (OpenCV), which counts them in sixteenths, too.
_STEP_PX, _PARTS = 16, 16


def normals_from_stereo(
    left: NDArray[np.floating[Any]],
    right: NDArray[np.floating[Any]],
    mask: NDArray[np.bool_],
    *,
    focal_px: float,
    baseline_m: float,
    nearest_m: float = 0.5,
    window_px: int = 9,
) -> NDArray[np.float32]:
    """Normals of an object in the left view, as well as matching can tell.

    Surfaces without texture match badly, so these normals are rough: that is what they are for,
    to see what a method makes of normals that one could really have.

    Args:
        left: (H, W, 3), display-encoded in [0, 1].
        right: The other view, from parallel cameras.
        mask: (H, W), the object in the left view.
        focal_px: The focal length.
        baseline_m: Between the cameras.
        nearest_m: Nothing is nearer than this.
        window_px: Of the planes that are fitted to the depth.

    Returns:
        (H, W, 3) float32 as of `normals_from_depth`; where nothing matches, the normal that
        looks at the camera.

    Raises:
        UsageError: See `depth_from_stereo`.
    """
    depth = depth_from_stereo(
        left, right, mask, focal_px=focal_px, baseline_m=baseline_m, nearest_m=nearest_m
    )
    normals = normals_from_depth(depth, mask & (depth > 0), focal_px, window_px=window_px)
    lost = mask & (np.abs(normals).sum(axis=-1) == 0)
    normals[lost] = (0.0, 0.0, 1.0)
    return normals


def depth_from_stereo(
    left: NDArray[np.floating[Any]],
    right: NDArray[np.floating[Any]],
    mask: NDArray[np.bool_],
    *,
    focal_px: float,
    baseline_m: float,
    nearest_m: float = 0.5,
) -> NDArray[np.float32]:
    """Depth along the view axis in meters, (H, W) float32; 0 off the mask and where unknown.

    Semi-global matching (Hirschmueller 2008) at twice the size, gaps filled from what lies
    around them. In parallel views depth is focal length times baseline over disparity. The
    arguments are those of `normals_from_stereo`.

    Raises:
        UsageError: If the shapes do not fit, the views are too small, or a length is not over 0.
    """
    if left.shape != right.shape or left.shape != (*mask.shape, 3):
        raise UsageError(
            f"Two views (H, W, 3) and a mask (H, W) go together, not {left.shape}, "
            f"{right.shape} and {mask.shape}."
        )
    if min(focal_px, baseline_m, nearest_m) <= 0:
        raise UsageError(
            f"Focal length {focal_px}, baseline {baseline_m} and nearest depth {nearest_m} are all "
            "more than 0."
        )
    height, width = mask.shape
    if width * _ENLARGED < 2 * _STEP_PX:
        raise UsageError(f"Views of {width} pixels are too narrow to match; {_STEP_PX} are needed.")
    size = (width * _ENLARGED, height * _ENLARGED)
    pair = [cv2.resize(_gray(view), size, interpolation=cv2.INTER_CUBIC) for view in (left, right)]
    most = focal_px * baseline_m / nearest_m * _ENLARGED
    steps = int(np.clip(np.ceil(most / _STEP_PX), 1, size[0] // _STEP_PX - 1)) * _STEP_PX
    # A column of the left view is matched with columns further left: so many are added there.
    padded = [cv2.copyMakeBorder(view, 0, 0, steps, 0, cv2.BORDER_REPLICATE) for view in pair]
    matcher = cv2.StereoSGBM.create(
        minDisparity=0, numDisparities=steps, blockSize=_BLOCK_PX,
        P1=2 * _BLOCK_PX**2, P2=32 * _BLOCK_PX**2, uniquenessRatio=5,
        mode=cv2.STEREO_SGBM_MODE_HH,
    )  # fmt: skip
    found = matcher.compute(*padded)[:, steps:].astype(np.float32) / _PARTS / _ENLARGED
    disparity = np.asarray(
        cv2.resize(found, (width, height), interpolation=cv2.INTER_NEAREST), np.float32
    )
    known = mask & (disparity > 0.25)
    filled = _fill(disparity, known, mask)
    depth = focal_px * baseline_m / np.maximum(filled, 1e-6)
    return np.where(mask & (filled > 0), depth, 0).astype(np.float32)


def _fill(
    disparity: NDArray[np.float32], known: NDArray[np.bool_], mask: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """Disparity on all of the mask: where it is not known, a mean of what is nearby."""
    if not known.any():
        return np.zeros_like(disparity)
    filled = np.where(known, disparity, 0).astype(np.float32)
    have = known.astype(np.float32)
    for radius in (3, 7, 15, 31, 63, 255):
        missing = mask & (have == 0)
        if not missing.any():
            break
        window = (2 * radius + 1, 2 * radius + 1)
        total = cv2.boxFilter(filled * have, -1, window, normalize=False)
        count = cv2.boxFilter(have, -1, window, normalize=False)
        near = missing & (count > 0.5)
        filled[near] = total[near] / count[near]
        have[near] = 1
    return np.asarray(cv2.medianBlur(filled, 5), np.float32)


def _gray(view: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    return np.rint(np.clip(luminance(np.asarray(view, np.float32)), 0, 1) * 255).astype(np.uint8)

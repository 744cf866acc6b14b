"""Normals that are not quite true, and normals of a depth picture."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError

# A window needs this much of a plane to tell how it lies.
_LEAST_SHARE = 0.15


def add_noise(
    normals: NDArray[np.floating[Any]],
    mask: NDArray[np.bool_],
    mean_deg: float,
    *,
    smooth_px: float = 0.0,
    seed: int = 0,
) -> NDArray[np.float32]:
    """Normals that are off by `mean_deg` on average.

    Each is tilted in a random direction by an angle whose two components are normally
    distributed. With `smooth_px` neighbors are tilted alike, as in estimates.

    Args:
        normals: (H, W, 3), of unit length where `mask` is true.
        mask: (H, W).
        mean_deg: The mean angle between the result and the truth, 0 to 45.
        smooth_px: Standard deviation of a blur of the tilts, 0 for none.
        seed: For the tilts.

    Returns:
        (H, W, 3) float32, zero where `mask` is false.

    Raises:
        UsageError: If `mean_deg` is not between 0 and 45, or the shapes do not fit.
    """
    if normals.shape != (*mask.shape, 3):
        raise UsageError(f"The mask of normals {normals.shape} is not {mask.shape}.")
    if not 0 <= mean_deg <= 45:
        raise UsageError(f"Normals can be off by 0 to 45 degrees on average, not {mean_deg}.")
    tilt = np.random.default_rng(seed).standard_normal((*mask.shape, 2))
    if smooth_px > 0:
        tilt = np.asarray(cv2.GaussianBlur(tilt, (0, 0), smooth_px), np.float64)
        tilt /= tilt.std()
    # The mean length of a vector of two unit normal components is sqrt(pi / 2).
    tilt *= np.deg2rad(mean_deg) / np.sqrt(np.pi / 2)
    truth = np.asarray(normals, np.float64)
    across, along = _tangents(truth)
    angle = np.linalg.norm(tilt, axis=-1, keepdims=True)
    toward = (across * tilt[..., :1] + along * tilt[..., 1:]) / np.maximum(angle, 1e-12)
    noisy = truth * np.cos(angle) + toward * np.sin(angle)
    return np.where(mask[..., None], noisy, 0).astype(np.float32)


def normals_from_depth(
    depth: NDArray[np.floating[Any]],
    mask: NDArray[np.bool_],
    focal_px: float,
    *,
    center_px: tuple[float, float] | None = None,
    window_px: int = 3,
) -> NDArray[np.float32]:
    """The normals of a surface of which the depth is known.

    Along a plane the inverse of depth is an affine function of the pixel's place; in each
    window it is fitted by least squares, and its three numbers are the normal.

    Args:
        depth: (H, W), along the view axis, positive where `mask` is true.
        mask: (H, W).
        focal_px: The focal length.
        center_px: Column and row of the view axis, pixel edges at integers; the middle if not
            given.
        window_px: Width of the windows, odd.

    Returns:
        (H, W, 3) float32 in the camera's frame (+X right, +Y up, +Z toward the camera), zero
        where `mask` is false or too little of a window is on the object.

    Raises:
        UsageError: If the shapes do not fit, or the window or the focal length is not possible.
    """
    if depth.shape != mask.shape or depth.ndim != 2:
        raise UsageError(f"Depth and mask are (H, W) both, not {depth.shape} and {mask.shape}.")
    if window_px < 3 or window_px % 2 == 0:
        raise UsageError(f"A window is 3, 5, ... pixels wide, not {window_px}.")
    if focal_px <= 0:
        raise UsageError(f"A focal length is more than 0 pixels, not {focal_px}.")
    seen = mask & (depth > 0)
    inverse = np.where(seen, 1 / np.where(seen, depth, 1), 0)
    return _normals_of_inverse(inverse, seen, focal_px, center_px, window_px)


def _normals_of_inverse(
    inverse: NDArray[np.float64],
    seen: NDArray[np.bool_],
    focal_px: float,
    center_px: tuple[float, float] | None,
    window_px: int,
) -> NDArray[np.float32]:
    height, width = seen.shape
    center = center_px or (width / 2, height / 2)
    x = ((np.arange(width) + 0.5 - center[0]) / focal_px)[None, :] + np.zeros((height, 1))
    y = ((np.arange(height) + 0.5 - center[1]) / focal_px)[:, None] + np.zeros((1, width))

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        window = (window_px, window_px)
        summed = cv2.boxFilter(values * seen, -1, window, borderType=cv2.BORDER_CONSTANT)
        return np.asarray(summed, np.float64)

    share = mean(np.ones_like(inverse))
    count = np.maximum(share, 1e-12)
    mx, my, mi = (mean(v) / count for v in (x, y, inverse))
    # Covariances as means of products less products of means: x and y are small about the view
    # axis, so doubles lose nothing that matters.
    xx, yy, xy = (mean(a * b) / count for a, b in ((x, x), (y, y), (x, y)))
    xi, yi = mean(x * inverse) / count, mean(y * inverse) / count
    sxx, syy, sxy = xx - mx * mx, yy - my * my, xy - mx * my
    sxi, syi = xi - mx * mi, yi - my * mi
    determinant = sxx * syy - sxy**2
    enough = seen & (share > _LEAST_SHARE) & (determinant > 1e-4 * sxx * syy)
    safe = np.where(enough, determinant, 1)
    slope_x = (syy * sxi - sxy * syi) / safe
    slope_y = (sxx * syi - sxy * sxi) / safe
    offset = mi - slope_x * mx - slope_y * my
    # (right, down, forward) -> (right, up, back), toward the camera: the offset is positive on
    # whatever can be seen.
    normal = np.stack([-slope_x, slope_y, offset], axis=-1)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.where(enough[..., None], normal / np.maximum(length, 1e-30), 0).astype(np.float32)


def _tangents(normals: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors across each normal and each other (Duff et al. 2017, listing 3)."""
    x, y, z = normals[..., 0], normals[..., 1], normals[..., 2]
    sign = np.where(z < 0, -1.0, 1.0)
    a = -1 / (sign + z)
    b = x * y * a
    first = np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    second = np.stack([b, sign + y * y * a, -y], axis=-1)
    return first, second

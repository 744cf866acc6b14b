"""Luminance and chroma of EXR files as RGB, and other primaries as Rec.709."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.primaries import REC709, luminance_weights, rec709_from_rgb
from panokit.errors import ImageError, UsageError


def file_primaries(path: Path, attributes: Mapping[str, Any]) -> tuple[float, ...]:
    """The primaries that a header names; Rec.709 with D65 where it names none (OpenEXR's rule).

    Eight zeros count as none.

    Raises:
        ImageError: If they span no color space.
    """
    named = attributes.get("chromaticities")
    if named is None:
        return REC709
    try:
        primaries = tuple(float(value) for value in np.asarray(named, np.float64).ravel())
        if not any(primaries):
            return REC709
        rec709_from_rgb(primaries)
    except (UsageError, TypeError, ValueError, np.linalg.LinAlgError) as error:
        raise ImageError(
            f"{path}: {error} Correct its chromaticities.", reason="wrong-color-model"
        ) from error
    return primaries


def to_rec709(
    pixels: NDArray[np.float32], primaries: Sequence[float], gain: float = 1.0
) -> NDArray[np.float32]:
    """Pixels (H, W, 3) of these primaries as linear Rec.709; the same array where they are."""
    matrix = rec709_from_rgb(primaries)
    if matrix is None and gain == 1.0:
        return pixels
    matrix = np.eye(3) if matrix is None else matrix
    with np.errstate(over="ignore", invalid="ignore"):  # found where values are checked
        return pixels @ (matrix.T * gain).astype(np.float32)


def rgb_from_luma_chroma(
    luma: NDArray[np.float32],
    red_chroma: NDArray[np.float32],
    blue_chroma: NDArray[np.float32],
    primaries: Sequence[float],
) -> NDArray[np.float32]:
    """RGB (H, W, 3) from Y, RY = (R - Y) / Y and BY = (B - Y) / Y.

    Chroma with fewer pixels is interpolated linearly, across the left and right border too:
    its samples lie on every second luma pixel, the first on the first. (OpenEXR, "Technical
    Introduction", luminance/chroma images; its own filter is longer.)
    """
    shape = luma.shape
    red = luma * (1 + _enlarged(red_chroma, shape))
    blue = luma * (1 + _enlarged(blue_chroma, shape))
    weights = luminance_weights(primaries)
    green = (luma - weights[0] * red - weights[2] * blue) / weights[1]
    return np.stack([red, green, blue], axis=-1).astype(np.float32, copy=False)


def _enlarged(plane: NDArray[np.float32], shape: tuple[int, ...]) -> NDArray[np.float32]:
    for axis in (0, 1):
        step = -(-shape[axis] // plane.shape[axis])
        if step == 1:
            continue
        position = np.arange(shape[axis]) / step
        low = np.floor(position).astype(int)
        share = (position - low).astype(np.float32)
        count = plane.shape[axis]
        high = (low + 1) % count if axis == 1 else np.minimum(low + 1, count - 1)
        share = share[:, None] if axis == 0 else share[None, :]
        plane = plane.take(low, axis) * (1 - share) + plane.take(high, axis) * share
    return plane

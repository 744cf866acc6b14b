"""Two maps that can be compared pixel by pixel, and how much each pixel counts."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError, UsageError
from panokit.sphere.solid_angle import row_solid_angles

Radiance = NDArray[np.floating[Any]]

Weighting = Literal["solid-angle", "pixel"]
"""Whether a pixel counts by the part of the sphere it covers, or as one pixel.

Published scores mostly count pixels, which makes the rows at the poles as heavy as the
horizon; panokit's own count solid angle.
"""


def check_same_shape(estimate: NDArray[Any], truth: NDArray[Any]) -> None:
    """Check that two maps can be compared pixel by pixel.

    Raises:
        UsageError: If not.
    """
    if estimate.shape != truth.shape or estimate.ndim != 3 or estimate.shape[2] != 3:
        raise UsageError(
            f"Maps to compare are both (H, W, 3), not {estimate.shape} and {truth.shape}. "
            "Resize one with panokit.sphere.resize_radiance."
        )


def radiance_pair(
    estimate: Radiance, truth: Radiance
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Both maps as float64, once it is sure that they can be compared.

    Args:
        estimate: (H, W, 3), linear radiance; W is 2 H, or H for the anamorphic 64x64 form.
        truth: As `estimate`, in the same frame and unit.

    Raises:
        UsageError: If the shapes differ.
        ImageError: If a map is not floating point, not a spherical picture, or not finite.
    """
    estimate, truth = np.asarray(estimate), np.asarray(truth)
    check_same_shape(estimate, truth)
    for radiance in (estimate, truth):
        check_radiance(radiance)
    return np.asarray(estimate, np.float64), np.asarray(truth, np.float64)


def check_radiance(radiance: NDArray[Any]) -> None:
    """Check that an array can be the radiance of a spherical picture.

    Raises:
        ImageError: If it is not floating point, (H, W, 3) with W of 2 H or H, and finite.
    """
    if not np.issubdtype(radiance.dtype, np.floating):
        raise ImageError(
            f"Radiance is floating point, not {radiance.dtype}. Decode display values with "
            "panokit.color.srgb_decode first.",
            reason="wrong-dtype",
        )
    if radiance.ndim != 3 or radiance.shape[2] != 3 or 0 in radiance.shape:
        raise ImageError(
            f"Expected RGB radiance of shape (H, W, 3), got {radiance.shape}.",
            reason="wrong-channels",
        )
    height, width = radiance.shape[:2]
    if width not in (height, 2 * height):
        raise ImageError(
            f"A map to score is 2:1, or 1:1 in the anamorphic form; this one is {width}x{height}. "
            "Convert it with panokit.sphere first.",
            reason="not-equirectangular",
            values={"width_px": width, "height_px": height},
        )
    if not np.isfinite(radiance).all():
        raise ImageError(
            f"{int((~np.isfinite(radiance)).sum())} values of a map to score are not finite. "
            "Replace them first; panokit.io does so when it reads a file.",
            reason="not-finite",
        )


def pixel_weights(shape: tuple[int, ...], weighting: Weighting) -> NDArray[np.float64]:
    """How much a pixel of each row counts, (H, 1) float64; over all pixels the sum is 1.

    Args:
        shape: Of the map, (H, W, ...).
        weighting: By what.

    Raises:
        UsageError: If the weighting is not known.
    """
    height_px, width_px = shape[:2]
    if weighting == "solid-angle":
        return row_solid_angles(height_px, width_px)[:, None] / (4 * np.pi)
    if weighting == "pixel":
        return np.full((height_px, 1), 1.0 / (height_px * width_px))
    raise UsageError(f"The weighting is 'solid-angle' or 'pixel', not {weighting!r}.")

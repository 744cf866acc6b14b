"""The one layout of pictures that cover the sphere: (H, W, 3) with W == 2 H."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError


def check_equirectangular(pixels: NDArray[Any]) -> None:
    """Check that an array is (H, W, 3) with W == 2 H, and big enough to be a picture.

    Raises:
        ImageError: If not, with the sizes and what to do.
    """
    if pixels.ndim != 3 or pixels.shape[2] != 3:
        raise ImageError(
            f"Expected RGB pixels of shape (H, W, 3), got {pixels.shape}.", reason="wrong-channels"
        )
    height, width = pixels.shape[:2]
    if width != 2 * height:
        raise ImageError(
            f"An equirectangular picture is twice as wide as high; this one is {width}x{height}. "
            "Crop or pad it to 2:1 first.",
            reason="not-equirectangular",
            values={"width_px": width, "height_px": height},
        )
    if height < 8:
        raise ImageError(
            f"{width}x{height} is too small for a spherical picture; 16x8 is the least.",
            reason="too-small",
            values={"width_px": width, "height_px": height},
        )


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """A read-only view; a view, so that the caller's own array stays writable."""
    view = np.asarray(array).view()
    view.setflags(write=False)
    return view

"""The lat-long layout of the OpenEXR specification.

By the letter of ImfEnvmap.h the outermost pixels have their centers *on* the seam and the
poles: the first and the last column show the same direction. Programs that follow it are
OpenEXR's own exrenvmap and what is built on its LatLongMap; most renderers, and USD's Hydra,
take the same file with pixel edges on the borders, as panokit writes it. +Y is up and the
center looks along +Z: with d of panokit, (-x, y, -z).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError
from panokit.frames import Frame
from panokit.io.adapters.nodes import (
    columns_as_cells,
    columns_from_seam_to_seam,
    rows_as_cells,
    rows_from_pole_to_pole,
)


def to_openexr_latlong(envmap: EnvironmentMap) -> NDArray[np.float32]:
    """The pixels of a lat-long map by the letter of the specification, (H, W, 3) float32.

    For programs that sample with OpenEXR's LatLongMap functions; all others want the pixels
    of `write_environment_map`, unchanged.
    """
    return columns_from_seam_to_seam(rows_from_pole_to_pole(envmap.radiance))


def from_openexr_latlong(
    pixels: NDArray[np.floating[Any]], *, frame: Frame = Frame.LEVEL
) -> EnvironmentMap:
    """A map from pixels by the letter of the specification, such as exrenvmap writes.

    Raises:
        ImageError: If they are not (H, 2 H, 3), or not physical.
    """
    pixels = np.asarray(pixels)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or min(pixels.shape[:2]) < 2:
        raise ImageError(
            f"A lat-long map is (H, W, 3) pixels, not {pixels.shape}.", reason="wrong-channels"
        )
    return EnvironmentMap(radiance=rows_as_cells(columns_as_cells(pixels)), frame=frame)

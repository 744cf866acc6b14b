"""What the gain network sees: a panorama pooled to a 128x64 grid.

The same function makes the network's input in training and in use.
"""

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.expand.reduce import ReducedPanorama
from panokit.sphere import resize_radiance

GRID_WIDTH_PX = 128
GRID_HEIGHT_PX = 64
# Contrast within a cell is measured at this width, so that it means the same for any input.
CONTRAST_WIDTH_PX = 1024

CHANNELS = (
    "encoded_r", "encoded_g", "encoded_b",
    "clear_r", "clear_g", "clear_b",
    "burnt_r", "burnt_g", "burnt_b",
    "share", "share_root", "white",
    "contrast", "log_luminance",
    "sin_latitude", "cos_latitude",
)  # fmt: skip


def grid_features(reduced: ReducedPanorama) -> NDArray[np.float32]:
    """The network's input, (16, 64, 128) float32; the channels are `CHANNELS`.

    Rolling the panorama by a whole number of cells rolls the features by as many.
    """
    reduced = reduced.at_width(min(reduced.width_px, CONTRAST_WIDTH_PX))
    pooled = reduced.at_width(GRID_WIDTH_PX)
    total = luminance(pooled.clear + pooled.burnt)
    latitude = (0.5 - (np.arange(GRID_HEIGHT_PX) + 0.5) / GRID_HEIGHT_PX) * np.pi
    rows = np.stack([np.sin(latitude), np.cos(latitude)], axis=-1)[:, None, :]
    features = np.dstack(
        [
            pooled.encoded,
            pooled.clear,
            pooled.burnt,
            pooled.share,
            np.sqrt(np.maximum(pooled.share, 0)),
            pooled.white,
            4 * _contrast(reduced),
            np.log(total + 1e-3) / 4,
            np.broadcast_to(rows, (GRID_HEIGHT_PX, GRID_WIDTH_PX, 2)),
        ]
    )
    return np.ascontiguousarray(features.transpose(2, 0, 1), np.float32)


def _contrast(reduced: ReducedPanorama) -> NDArray[np.float32]:
    """The standard deviation of encoded luminance within each cell."""
    encoded = luminance(reduced.encoded)
    moments = resize_radiance(np.dstack([encoded, encoded**2]), GRID_WIDTH_PX)
    return np.sqrt(np.maximum(moments[..., 1] - moments[..., 0] ** 2, 0))

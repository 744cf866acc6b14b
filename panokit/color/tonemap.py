"""Pictures of HDR maps for people to look at; never for measuring."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.color.transfer import srgb_encode_u8


def bracket(
    radiance: NDArray[np.floating[Any]], stops: Sequence[float] = (0.0, -2.0, -4.0, -8.0)
) -> list[NDArray[np.uint8]]:
    """The radiance as a camera would show it at several exposures, sRGB-encoded and clipped.

    Args:
        radiance: (H, W, 3), linear; 1.0 is white at 0 stops.
        stops: Exposure values; -2 shows radiance 4 as white.
    """
    return [srgb_encode_u8(np.asarray(radiance) * np.float32(2.0**ev)) for ev in stops]


def tonemap(radiance: NDArray[np.floating[Any]], *, key: float = 0.18) -> NDArray[np.uint8]:
    """One picture with everything in it: Reinhard's global operator, on luminance.

    Reinhard et al. 2002, "Photographic Tone Reproduction for Digital Images", equations 1-4,
    with the white level at the 99.9th percentile so that one sun does not darken the rest.

    Args:
        radiance: (H, W, 3), linear.
        key: What the log-average luminance becomes.
    """
    radiance = np.asarray(radiance, np.float32)
    scene = luminance(radiance)
    log_average = float(np.exp(np.mean(np.log(scene + 1e-6 * float(scene.max() or 1)))))
    scaled = scene * np.float32(key / max(log_average, 1e-12))
    white = max(float(np.percentile(scaled, 99.9)), 1.0)
    display = scaled * (1 + scaled / white**2) / (1 + scaled)
    return srgb_encode_u8(radiance * (display / np.maximum(scene, 1e-12))[..., None])

"""A map as rough mirrors see it: blurred with the lobe of a GGX surface.

With view, normal and mirror direction taken as one, as renderers do that keep prefiltered maps
(Karis 2013, "Real Shading in Unreal Engine 4", the split sum), the lobe is round: light from an
angle t off the mirror direction counts with D(t / 2) cos t, where D is the GGX distribution of
microfacets (Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces",
equation 33). A round lobe is a convolution along each pair of rows, done by Fourier transform.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

from panokit.errors import UsageError
from panokit.sphere import resize_radiance, row_solid_angles

# The lobe spans this many pixels to the angle at which D has fallen to a quarter, or more.
_PIXELS_TO_SLOPE = 3
_WIDTHS_PX = (64, 128, 256, 512)


def prefilter_ggx(radiance: NDArray[np.floating], roughness: float) -> NDArray[np.float32]:
    """The light that a surface of this roughness mirrors, for each mirror direction.

    Args:
        radiance: (H, W, 3), equirectangular, linear.
        roughness: Of the material, 0 to 1; alpha of the distribution is its square, as in glTF.

    Returns:
        (h, w, 3) float32, smaller where the lobe is broad; the map itself for roughness 0. A
        uniform map stays uniform.

    Raises:
        UsageError: If the roughness is not 0 to 1.
    """
    if not 0 <= roughness <= 1:
        raise UsageError(f"Roughness is 0 to 1, not {roughness}.")
    radiance = np.asarray(radiance, np.float32)
    alpha = roughness**2
    if alpha == 0:
        return radiance
    # D falls to a quarter where tan of the half angle is alpha.
    needed = _PIXELS_TO_SLOPE * 2 * np.pi / (2 * np.arctan(alpha))
    width = next((w for w in _WIDTHS_PX if w >= needed), _WIDTHS_PX[-1])
    small = resize_radiance(radiance, min(width, radiance.shape[1]))
    height, width = small.shape[:2]
    weights = row_solid_angles(height, width)
    spectrum = rfft(small.astype(np.float64), axis=1) * weights[:, None, None]
    polar = (np.arange(height) + 0.5) * (np.pi / height)
    turns = np.cos(np.arange(width) * (2 * np.pi / width))
    made = np.empty(small.shape, np.float64)
    for row, angle in enumerate(polar):
        cosine = (
            np.cos(angle) * np.cos(polar)[:, None] + np.sin(angle) * np.sin(polar)[:, None] * turns
        )
        lobe = _lobe(cosine, alpha)
        total = float((lobe * weights[:, None]).sum())
        # The lobe is even, so its transform is real.
        made[row] = (
            irfft(np.einsum("rm,rmc->mc", rfft(lobe, axis=1).real, spectrum), width, axis=0) / total
        )
    return np.asarray(np.maximum(made, 0), np.float32)


def _lobe(cosine: NDArray[np.float64], alpha: float) -> NDArray[np.float64]:
    """D(t / 2) cos t at the cosine of t, without D's constant factor."""
    half_squared = (1 + cosine) / 2  # cos^2 (t / 2)
    slope = half_squared * (alpha**2 - 1) + 1
    return np.asarray(np.maximum(cosine, 0) / np.maximum(slope, 1e-12) ** 2)

"""A few numbers that say what light a map has, whichever way it is turned.

Two probes are alike when they would teach a model the same: as much contrast, spread over the
sphere as broadly or as finely, of the same color. Where it comes from does not count, since
datasets turn their probes anyway. So the map is taken as log2(1 + luminance / mean) and two
color ratios, and of their spherical harmonics only the power of each degree is kept, which no
rotation changes (Kazhdan, Funkhouser and Rusinkiewicz 2003, "Rotation Invariant Spherical
Harmonic Representation of 3D Shape Descriptors").

    0 - 6    root of the power of degrees 0 to 6 of the compressed luminance, blurred by 3.5 degrees
    7, 8     the light's color: log2 R/G and B/G of its energy
    9, 10    how the color changes over the sphere: root power of degrees 1 to 3 of each ratio
    11       share of the energy from the brightest 0.1 % of the sphere, as log10
    12       stops from the median to the peak

Each is divided by how much it varies among 77 captured probes of all categories, so that the
distance of two descriptors treats them alike: about 1 is a common difference.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance, weighted_percentile
from panokit.sphere import (
    blur_radiance,
    energy,
    harmonics_degrees,
    pixel_solid_angles,
    project_harmonics,
    resize_radiance,
    row_solid_angles,
)

LENGTH = 13
_WIDTH_PX = 128
# About 3.5 degrees, more than a pixel of such a map.
_BLUR_KAPPA = 270.0
_ORDER, _COLOR_ORDER = 6, 3
_DIGITS = 4
# The standard deviation of each number over 77 probes by HDRI Haven, rounded.
_SPREAD = np.array(
    [0.19, 0.14, 0.092, 0.071, 0.071, 0.058, 0.064, 0.27, 0.47, 0.17, 0.24, 0.60, 4.4]
)
# Ratios of dark pixels mean little: this share of the mean is added to both sides.
_FLOOR = 0.02
_TOP_SHARE = 1e-3


def descriptor(radiance: NDArray[np.floating[Any]]) -> tuple[float, ...]:
    """The descriptor of a map, thirteen numbers, the same for any rotation of it.

    Args:
        radiance: (H, W, 3), equirectangular, linear, finite, at least 0. Its scale does not
            count.

    Returns:
        Rounded to four digits, so that the same map gives the same on any machine; all 0 for
        a black map.
    """
    radiance = np.asarray(radiance, np.float32)
    whole = energy(radiance)
    mean = float(luminance(whole)) / (4 * np.pi)
    if mean <= 0:
        return (0.0,) * LENGTH
    small = resize_radiance(radiance, min(_WIDTH_PX, radiance.shape[1]))
    # The logarithm would tell a sun in one pixel from one that four of them share.
    small = blur_radiance(small, _BLUR_KAPPA).astype(np.float64)
    shine = np.log2(1 + luminance(small) / mean)[..., None]
    floor = _FLOOR * mean
    red, green, blue = np.moveaxis(small + floor, -1, 0)
    ratios = np.log2(np.stack([red / green, blue / green], axis=-1))
    order = min(_ORDER, (small.shape[0] - 1) // 2)
    powers = np.zeros(_ORDER + 1)
    powers[: order + 1] = _root_powers(shine, order)[:, 0]
    colors = _root_powers(ratios, min(_COLOR_ORDER, order))[1:]
    spread = np.sqrt((colors**2).sum(axis=0))
    tint = np.log2((whole + 1e-6 * whole.max())[[0, 2]] / (whole[1] + 1e-6 * whole.max()))
    values = np.concatenate([powers, tint, spread, _contrast(radiance)])
    return tuple(round(float(value), _DIGITS) for value in values / _SPREAD)


def distances(
    descriptors: NDArray[np.floating[Any]], one: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    """How far descriptors (N, 13) are from one (13,); (N,) float64."""
    return np.asarray(np.linalg.norm(descriptors - one, axis=1), np.float64)


def _root_powers(values: NDArray[np.float64], order: int) -> NDArray[np.float64]:
    """The root of the mean square over the sphere of each degree, (order + 1, C)."""
    coefficients = project_harmonics(values, order)
    degrees = harmonics_degrees(order)
    squares = np.stack(
        [(coefficients[degrees == degree] ** 2).sum(axis=0) for degree in range(order + 1)]
    )
    return np.asarray(np.sqrt(squares / (4 * np.pi)))


def _contrast(radiance: NDArray[np.float32]) -> NDArray[np.float64]:
    """The share of the energy in the brightest 0.1 % of the sphere, and stops to the peak.

    On the map reduced to 512 columns: a peak is measured over half a degree, the sun's width,
    so that maps of different sizes compare.
    """
    small = resize_radiance(radiance, min(512, radiance.shape[1]))
    light = luminance(small).astype(np.float64)
    angles = pixel_solid_angles(light.shape[0])
    order = np.argsort(-light, axis=None)
    covered = np.minimum(np.cumsum(angles.ravel()[order]), _TOP_SHARE * 4 * np.pi)
    top = float(light.ravel()[order] @ np.diff(covered, prepend=0.0))
    share = top / float((light * angles).sum())
    median = weighted_percentile(light, row_solid_angles(light.shape[0])[:, None], 50)
    peak = float(light.max())
    stops = float(np.log2(peak / max(median, 1e-6 * peak)))
    return np.array([np.log10(max(share, 1e-6)), stops])

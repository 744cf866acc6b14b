"""How far an environment map is from the true light, in the terms that relighting feels.

Protocol "panokit-lighting-1": both maps have the same size and scale (see
`panokit.metrics.alignment`); sums over the sphere are weighted by exact solid angles.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.frames import angle_between
from panokit.metrics.pairs import Radiance, check_radiance, check_same_shape
from panokit.sphere import (
    energy,
    equirect_directions,
    irradiance,
    light_vector,
    pixel_solid_angles,
)
from panokit.sphere.extension import pad_sphere

SIX_AXES = np.array(
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float64
)
SIX_AXES.setflags(write=False)

_PEAK_SIGMA_PX = 2.0


def energy_ratio(estimate: Radiance, truth: Radiance) -> float:
    """The estimate's luminance energy over the truth's; 1 is right, NaN if the truth is black."""
    _check(estimate, truth)
    return _ratio(float(_total(luminance(estimate))), float(_total(luminance(truth))))


def beyond_clip_ratio(estimate: Radiance, truth: Radiance, clip: float = 1.0) -> float:
    """The ratio of luminance energy over the pixels where the truth is brighter than `clip`.

    NaN where no pixel is.
    """
    _check(estimate, truth)
    check_same_shape(estimate, truth)
    bright = luminance(truth) > clip
    true = float(_total(luminance(truth) * bright))
    return _ratio(float(_total(luminance(estimate) * bright)), true)


def irradiance_errors(estimate: Radiance, truth: Radiance) -> NDArray[np.float64]:
    """The relative error of luminance irradiance on +x, -x, +y, -y, +z, -z; (6,) float64."""
    _check(estimate, truth)
    guess = luminance(irradiance(estimate, SIX_AXES))
    true = luminance(irradiance(truth, SIX_AXES))
    return np.asarray(np.abs(guess - true) / np.maximum(true, 1e-12), np.float64)


def light_vector_error_deg(estimate: Radiance, truth: Radiance) -> float:
    """The angle between the light vectors: which way the light comes from on the whole."""
    _check(estimate, truth)
    return float(np.degrees(angle_between(light_vector(estimate), light_vector(truth))))


def peak_direction(radiance: Radiance) -> NDArray[np.float64]:
    """The direction of the brightest spot, (3,).

    Luminance is blurred by a Gaussian of 2 pixels over the seam and the poles; the direction
    is the mean of all pixels within 0.1 % of the maximum, so that ties are shared fairly.
    """
    _check(radiance)
    light = np.ascontiguousarray(luminance(radiance), np.float32)
    pad = int(4 * _PEAK_SIGMA_PX)
    blurred = cv2.GaussianBlur(pad_sphere(light, pad), (0, 0), _PEAK_SIGMA_PX)[pad:-pad, pad:-pad]
    height, width = light.shape
    top = (blurred >= 0.999 * blurred.max()) * blurred * pixel_solid_angles(height, width)
    mean = np.tensordot(top, equirect_directions(width, height), axes=([0, 1], [0, 1]))
    return np.asarray(mean / max(float(np.linalg.norm(mean)), 1e-12), np.float64)


def peak_error_deg(estimate: Radiance, truth: Radiance) -> float:
    """The angle between the brightest spots of two maps, see `peak_direction`."""
    return float(np.degrees(angle_between(peak_direction(estimate), peak_direction(truth))))


def _check(*radiances: Radiance) -> None:
    for radiance in radiances:
        check_radiance(np.asarray(radiance))


def _total(light: Radiance) -> float:
    return float(energy(light[..., None])[0])


def _ratio(a: float, b: float) -> float:
    return a / b if b > 0 else float("nan")

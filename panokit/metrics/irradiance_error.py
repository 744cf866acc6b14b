"""How wrong surfaces under the estimate would be lit: irradiance over all normals.

By Parseval's theorem the mean square of irradiance over all directions is a sum over spherical
harmonics: E has the coefficients A_l c_lm with A = pi, 2 pi / 3, pi / 4 for the degrees 0 to 2
(Ramamoorthi and Hanrahan 2001, "An efficient representation for irradiance environment maps"),
which hold 99 % of it. So the error over all normals costs nine numbers per channel.
"""

from dataclasses import dataclass

import numpy as np

from panokit.metrics.lighting import irradiance_errors
from panokit.metrics.pairs import Radiance, radiance_pair
from panokit.sphere.harmonics import harmonics_degrees, project_harmonics

_ORDER = 2
_COSINE_LOBE = np.array([np.pi, 2 * np.pi / 3, np.pi / 4])


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisErrors:
    """Relative errors of luminance irradiance on the six axes.

    Attributes:
        mean: Over the six.
        max: The largest.
    """

    mean: float
    max: float


def irradiance_sh_error(estimate: Radiance, truth: Radiance) -> float:
    """The RMS over all normals and channels of the irradiance error, over that of irradiance.

    Args:
        estimate: (H, W, 3), linear, on the truth's scale.
        truth: (H, W, 3), linear.

    Returns:
        0 is equal, 1 is as wrong as darkness; NaN if the truth is black.
    """
    guess, true = radiance_pair(estimate, truth)
    lobe = _COSINE_LOBE[harmonics_degrees(_ORDER)][:, None]
    difference = lobe * project_harmonics(guess - true, _ORDER)
    received = lobe * project_harmonics(true, _ORDER)
    whole = float((received**2).sum())
    return float(np.sqrt((difference**2).sum() / whole)) if whole > 0 else float("nan")


def irradiance_axis_errors(estimate: Radiance, truth: Radiance) -> AxisErrors:
    """`panokit.metrics.lighting.irradiance_errors` as two numbers."""
    radiance_pair(estimate, truth)
    errors = irradiance_errors(estimate, truth)
    return AxisErrors(mean=float(errors.mean()), max=float(errors.max()))

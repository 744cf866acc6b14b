"""How warm or cool a light is: chromaticity and correlated color temperature.

A warm lamp is near 2700 K, noon daylight near 5500 K, an overcast sky near 6500 K, and a clear
blue sky from 10000 K up.
"""

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.primaries import REC709, xyz_from_rgb
from panokit.errors import UsageError

_XYZ_FROM_REC709 = xyz_from_rgb(REC709)
_XYZ_FROM_REC709.setflags(write=False)

# CIE 15: the concept is not to be used farther than this from the Planckian locus.
MOST_DUV = 0.05
# Ohno's method is made for this range; beyond it a small change of color is thousands of kelvin.
_KELVIN = (1000.0, 40000.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ColorTemperature:
    """The black body whose color is nearest, and how far from it the color is.

    Attributes:
        kelvin: The correlated color temperature.
        duv: The distance from the Planckian locus in CIE 1960 (u, v): positive is greener
            than a black body, negative pinker. Daylight is near +0.003; a lamp beyond 0.006
            looks tinted.
    """

    kelvin: float
    duv: float


def chromaticity(linear: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The CIE 1931 (x, y) of linear Rec.709 values, (..., 3) -> (..., 2); NaN for black."""
    linear = np.asarray(linear, np.float64)
    if linear.shape[-1:] != (3,):
        raise UsageError(f"Colors have shape (..., 3), not {linear.shape}.")
    xyz = linear @ _XYZ_FROM_REC709.T
    total = xyz.sum(axis=-1, keepdims=True)
    return np.where(total > 0, xyz[..., :2] / np.where(total > 0, total, 1.0), np.nan)


def color_temperature(linear: NDArray[np.floating[Any]]) -> ColorTemperature | None:
    """The correlated color temperature of one light, or None where there is no such thing.

    Ohno 2013, "Practical Use and Calculation of CCT and Duv", as colour-science does it.

    Args:
        linear: (3,), linear Rec.709 with white D65, of any scale: a light's energy, or a
            map's mean radiance.

    Returns:
        None for black, for a color farther than 0.05 from the Planckian locus (a green or
        magenta stage light), and for one outside 1000 to 40000 K.

    Raises:
        UsageError: If the color is not three finite numbers.
    """
    linear = np.asarray(linear, np.float64)
    if linear.shape != (3,) or not np.isfinite(linear).all():
        raise UsageError(f"A color is three finite numbers, not {linear.tolist()}.")
    if linear.min() < 0 or linear.max() <= 0:
        return None
    # It takes a second to import, which only those pay who ask for a temperature.
    from colour.temperature import uv_to_CCT_Ohno2013

    x, y = chromaticity(linear)
    scale = -2 * x + 12 * y + 3
    # At the ends of its table it warns; those temperatures are refused below.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        kelvin, duv = uv_to_CCT_Ohno2013(np.array([4 * x, 6 * y]) / scale)
    if not (_KELVIN[0] <= kelvin <= _KELVIN[1]) or not abs(duv) <= MOST_DUV:
        return None
    return ColorTemperature(kelvin=float(kelvin), duv=float(duv))

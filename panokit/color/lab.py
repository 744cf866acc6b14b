"""CIE L*a*b* of display-encoded RGB, both ways, with inverses that are exact.

Formulas: IEC 61966-2-1 for the transfer curve, CIE 15:2004, section 8.2, for L*a*b*, white D65.
The published pairs of matrices are rounded each on its own, so that there and back again is
off by up to a thousandth in the darks; here the second matrix is the first one's inverse.
Beyond [0, 1] all curves go on, so nothing is clipped.

`LabScheme.PIX2PIX` keeps the rounded matrices that image-to-image networks of 2017 used, to
compare with them.
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.primaries import REC709, xyz_from_rgb

Values = NDArray[np.floating[Any]]
# CIE: below (6/29)^3 the cube root is replaced by a line.
_EDGE = 6 / 29


class LabScheme(StrEnum):
    """Which matrices; see the module."""

    EXACT = "exact"
    PIX2PIX = "pix2pix"


@dataclass(frozen=True, slots=True, eq=False)
class LabMatrices:
    """The two matrices of a scheme, white divided out.

    Attributes:
        xyz_from_rgb: (3, 3) float64; white becomes (1, 1, 1).
        rgb_from_xyz: (3, 3) float64.
    """

    xyz_from_rgb: NDArray[np.float64]
    rgb_from_xyz: NDArray[np.float64]


@lru_cache(maxsize=2)
def lab_matrices(scheme: LabScheme) -> LabMatrices:
    """The matrices of a scheme."""
    if scheme is LabScheme.EXACT:
        forward = xyz_from_rgb(REC709)
        forward = forward / forward.sum(axis=1, keepdims=True)
        return LabMatrices(forward, np.linalg.inv(forward))
    forward = np.array([[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169],
                        [0.019334, 0.119193, 0.950227]])  # fmt: skip
    backward = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                         [0.0556434, -0.2040259, 1.0572252]])  # fmt: skip
    white = np.array([0.950456, 1.0, 1.088754])
    return LabMatrices(forward / white[:, None], backward * white)


def lab_from_rgb(encoded: Values, scheme: LabScheme = LabScheme.EXACT) -> Values:
    """L* (0 to 100), a* and b* of display-encoded RGB (..., 3); the dtype is kept."""
    encoded = np.asarray(encoded)
    linear = _decode(encoded)
    xyz = linear @ lab_matrices(scheme).xyz_from_rgb.T.astype(linear.dtype)
    root = np.where(xyz > _EDGE**3, np.cbrt(np.maximum(xyz, _EDGE**3)),
                    xyz / (3 * _EDGE**2) + 4 / 29)  # fmt: skip
    x, y, z = root[..., 0], root[..., 1], root[..., 2]
    lab = np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)
    return lab.astype(encoded.dtype, copy=False)


def rgb_from_lab(lab: Values, scheme: LabScheme = LabScheme.EXACT) -> Values:
    """Display-encoded RGB (..., 3) of L*, a*, b*; not clipped; the dtype is kept."""
    lab = np.asarray(lab)
    y = (lab[..., 0] + 16) / 116
    root = np.stack([y + lab[..., 1] / 500, y, y - lab[..., 2] / 200], axis=-1)
    xyz = np.where(root > _EDGE, root**3, 3 * _EDGE**2 * (root - 4 / 29))
    linear = xyz @ lab_matrices(scheme).rgb_from_xyz.T.astype(xyz.dtype)
    return _encode(linear).astype(lab.dtype, copy=False)


# The sRGB curve without its clipping: a straight line below, the power above, and beyond 1 too.
_LINE = 12.92
_ENCODED_EDGE = 0.04045
_LINEAR_EDGE = _ENCODED_EDGE / _LINE


def _decode(encoded: Values) -> Values:
    curve = ((np.maximum(encoded, _ENCODED_EDGE) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= _ENCODED_EDGE, encoded / _LINE, curve).astype(encoded.dtype)


def _encode(linear: Values) -> Values:
    curve = 1.055 * np.maximum(linear, _LINEAR_EDGE) ** (1 / 2.4) - 0.055
    return np.where(linear <= _LINEAR_EDGE, _LINE * linear, curve).astype(linear.dtype)

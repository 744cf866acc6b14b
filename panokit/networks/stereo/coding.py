"""The torch twin of `panokit.color.hdr_coding`, in single precision and with gradients."""

import math

import torch
from torch import Tensor

from panokit.color.hdr_coding import ColorCode, HdrCoding
from panokit.color.lab import LabScheme, lab_matrices

# CIE 15: where the cube root of L*a*b* gives way to a line.
_EDGE = 6 / 29
# IEC 61966-2-1: the slope of the line of sRGB, and where its curve begins.
_LINE, _ENCODED_EDGE = 12.92, 0.04045
_LINEAR_EDGE = _ENCODED_EDGE / _LINE


def encode(radiance: Tensor, coding: HdrCoding) -> Tensor:
    """Code values of radiance (B, 3, H, W) >= 0; equal to `HdrCoding.encode`."""
    logs = torch.log1p(radiance) / coding.log_max
    if coding.color is ColorCode.RGB:
        return 2 * logs - 1
    linear = srgb_decode(logs)
    matrix = torch.as_tensor(
        lab_matrices(_scheme(coding)).xyz_from_rgb, dtype=linear.dtype, device=linear.device
    )
    x, y, z = torch.einsum("ij,bjhw->ibhw", matrix, linear).unbind()
    x, y, z = (
        torch.where(v > _EDGE**3, v.clamp(min=_EDGE**3) ** (1 / 3), v / (3 * _EDGE**2) + 4 / 29)
        for v in (x, y, z)
    )
    return torch.stack([(116 * y - 16) / 50 - 1, 500 * (x - y) / 110, 200 * (y - z) / 110], dim=1)


def decode(code: Tensor, coding: HdrCoding, *, most: float | None = None) -> Tensor:
    """Radiance (B, 3, H, W) >= 0 of code values; equal to `HdrCoding.decode`.

    The compatible variant clips as it always did, so it has no gradient beyond [0, 1].

    Args:
        code: (B, 3, H, W).
        coding: Of it.
        most: The brightest radiance that comes out, if given. In training the exponential of a
            wild guess would be infinite in single precision, and its gradient not a number.
    """
    is_rgb = coding.color is ColorCode.RGB
    logs = (code + 1) / 2 if is_rgb else _rgb_from_lab(code, _scheme(coding))
    if coding.color is ColorCode.PIX2PIX:
        logs = logs.clamp(0, 1)
    if most is not None:
        logs = logs.clamp(max=math.log1p(most) / coding.log_max)
    return torch.expm1(logs.clamp(min=0) * coding.log_max)


def _rgb_from_lab(code: Tensor, scheme: LabScheme) -> Tensor:
    lightness, a, b = ((code[:, 0] + 1) * 50, code[:, 1] * 110, code[:, 2] * 110)
    y = (lightness + 16) / 116
    root = torch.stack([y + a / 500, y, y - b / 200], dim=1)
    xyz = torch.where(root > _EDGE, root**3, 3 * _EDGE**2 * (root - 4 / 29))
    matrix = torch.as_tensor(lab_matrices(scheme).rgb_from_xyz, dtype=xyz.dtype, device=xyz.device)
    return _srgb_encode(torch.einsum("ij,bjhw->bihw", matrix, xyz))


def srgb_decode(encoded: Tensor) -> Tensor:
    """Light of sRGB values, any shape (IEC 61966-2-1); the twin of `panokit.color.srgb_decode`.

    What the curve does not hold for is clamped before the power: a power of a negative number has
    no gradient, and a gradient that is not a number spoils the whole batch.
    """
    curve = ((encoded.clamp(min=_ENCODED_EDGE) + 0.055) / 1.055) ** 2.4
    return torch.where(encoded <= _ENCODED_EDGE, encoded / _LINE, curve)


def _srgb_encode(linear: Tensor) -> Tensor:
    """The way back."""
    curve = 1.055 * linear.clamp(min=_LINEAR_EDGE) ** (1 / 2.4) - 0.055
    return torch.where(linear <= _LINEAR_EDGE, _LINE * linear, curve)


def _scheme(coding: HdrCoding) -> LabScheme:
    return LabScheme.PIX2PIX if coding.color is ColorCode.PIX2PIX else LabScheme.EXACT

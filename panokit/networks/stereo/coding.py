"""The torch twin of `panokit.color.hdr_coding`: code values to radiance, with gradients."""

import torch
from torch import Tensor

from panokit.color.hdr_coding import ColorCode, HdrCoding
from panokit.color.lab import LabScheme, lab_matrices

_EDGE = 6 / 29
_LINE, _LINEAR_EDGE = 12.92, 0.04045 / 12.92


def decode(code: Tensor, coding: HdrCoding) -> Tensor:
    """Radiance (B, 3, H, W) >= 0 of code values; equal to `HdrCoding.decode`.

    The compatible variant clips as it always did, so it has no gradient beyond [0, 1].
    """
    if coding.color is ColorCode.RGB:
        logs = (code + 1) / 2
    else:
        scheme = LabScheme.PIX2PIX if coding.color is ColorCode.PIX2PIX else LabScheme.EXACT
        logs = _rgb_from_lab(code, scheme)
    if coding.color is ColorCode.PIX2PIX:
        logs = logs.clamp(0, 1)
    return torch.expm1(logs.clamp(min=0) * coding.log_max)


def _rgb_from_lab(code: Tensor, scheme: LabScheme) -> Tensor:
    lightness, a, b = ((code[:, 0] + 1) * 50, code[:, 1] * 110, code[:, 2] * 110)
    y = (lightness + 16) / 116
    root = torch.stack([y + a / 500, y, y - b / 200], dim=1)
    xyz = torch.where(root > _EDGE, root**3, 3 * _EDGE**2 * (root - 4 / 29))
    matrix = torch.as_tensor(lab_matrices(scheme).rgb_from_xyz, dtype=xyz.dtype, device=xyz.device)
    linear = torch.einsum("ij,bjhw->bihw", matrix, xyz)
    curve = 1.055 * linear.clamp(min=_LINEAR_EDGE) ** (1 / 2.4) - 0.055
    return torch.where(linear <= _LINEAR_EDGE, _LINE * linear, curve)

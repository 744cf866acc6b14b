"""The torch twin of `panokit.expand.curve.apply_curve`."""

import torch
from torch import Tensor

from panokit.expand.curve import BEND, DARKEST


def apply_curve(linear: Tensor, slopes: Tensor) -> Tensor:
    """sRGB-decoded values (B, ...) in [0, 1] to the light behind them; slopes (B, 2)."""
    dark, white = slopes.reshape(len(slopes), 2, *[1] * (linear.dim() - 1)).unbind(dim=1)
    log_value = linear.clamp(min=DARKEST).log()
    bend = (dark - white) * BEND * (1 - torch.exp(log_value / BEND))
    return torch.exp(dark * log_value + bend)

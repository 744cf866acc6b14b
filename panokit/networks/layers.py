"""Layers that know that a panorama is closed in longitude."""

import torch
from torch import Tensor, nn
from torch.nn import functional as F


def pad_sphere_by_one(x: Tensor) -> Tensor:
    """One more pixel on each side of (B, C, H, W): columns wrap, rows repeat.

    Slices and concatenation export to operators that every ONNX runtime has.
    """
    wide = torch.cat([x[..., -1:], x, x[..., :1]], dim=-1)
    return torch.cat([wide[..., :1, :], wide, wide[..., -1:, :]], dim=-2)


class SphereConv(nn.Module):
    """3x3 convolution, group normalization over 4 groups, SiLU."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.convolution = nn.Conv2d(inputs, outputs, 3)
        self.norm = nn.GroupNorm(4, outputs)

    def forward(self, x: Tensor) -> Tensor:
        """(B, inputs, H, W) to (B, outputs, H, W)."""
        return F.silu(self.norm(self.convolution(pad_sphere_by_one(x))))


class SphereBlock(nn.Module):
    """Two convolutions; a code (B, C), if there is one, scales and shifts in between (FiLM).

    FiLM: Perez et al. 2018, "FiLM: Visual Reasoning with a General Conditioning Layer".
    """

    def __init__(self, inputs: int, outputs: int, code: int = 0) -> None:
        super().__init__()
        self.first = SphereConv(inputs, outputs)
        self.second = SphereConv(outputs, outputs)
        self.film = nn.Linear(code, 2 * outputs) if code else None

    def forward(self, x: Tensor, code: Tensor | None = None) -> Tensor:
        """(B, inputs, H, W) to (B, outputs, H, W)."""
        x = self.first(x)
        if self.film is not None and code is not None:
            scale, shift = self.film(code)[:, :, None, None].chunk(2, dim=1)
            x = x * (1 + scale) + shift
        return self.second(x)

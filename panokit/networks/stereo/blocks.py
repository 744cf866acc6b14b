"""The two blocks of the 2018 thesis (section 3.1), with as many layers as one likes.

Encode: convolutions that keep the size, batch normalization, a max-pool that alone changes the
size, ReLU. Decode: a transposed convolution that doubles the size, more that keep it, batch
normalization, ReLU.
"""

import itertools

import torch
from torch import Tensor, nn
from torch.nn import functional as F


class Encode(nn.Module):
    """`layers` 3x3 convolutions, batch normalization, 2x2 max-pool, ReLU."""

    def __init__(self, inputs: int, outputs: int, layers: int, *, pool: bool = True) -> None:
        super().__init__()
        counts = [inputs] + [outputs] * layers
        self.convolutions = nn.Sequential(
            *(nn.Conv2d(a, b, 3, padding=1) for a, b in itertools.pairwise(counts))
        )
        self.norm = nn.BatchNorm2d(outputs)
        self.pool = pool

    def forward(self, x: Tensor) -> Tensor:
        """(B, inputs, H, W) to (B, outputs, H / 2, W / 2), or H, W without the pool."""
        x = self.norm(self.convolutions(x))
        return F.relu(F.max_pool2d(x, 2) if self.pool else x)


class Decode(nn.Module):
    """A transposed convolution to twice the size, more at that size, normalization, ReLU."""

    def __init__(self, inputs: int, outputs: int, layers: int, *, wrap: bool = False) -> None:
        super().__init__()
        self.enlarge = nn.ConvTranspose2d(inputs, outputs, 4, stride=2, padding=1)
        self.more = nn.ModuleList(
            WrappedConvolution(outputs, outputs) if wrap
            else nn.ConvTranspose2d(outputs, outputs, 3, padding=1)
            for _ in range(layers - 1)
        )  # fmt: skip
        self.norm = nn.BatchNorm2d(outputs)

    def forward(self, x: Tensor) -> Tensor:
        """(B, inputs, H, W) to (B, outputs, 2 H, 2 W)."""
        x = self.enlarge(x)
        for layer in self.more:
            x = layer(x)
        return F.relu(self.norm(x))


class WrappedConvolution(nn.Module):
    """A 3x3 convolution on a map that is closed in azimuth; rows repeat at the poles."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.convolution = nn.Conv2d(inputs, outputs, 3)

    def forward(self, x: Tensor) -> Tensor:
        """(B, inputs, H, W) to (B, outputs, H, W)."""
        wide = torch.cat([x[..., -1:], x, x[..., :1]], dim=-1)
        return self.convolution(torch.cat([wide[..., :1, :], wide, wide[..., -1:, :]], dim=-2))

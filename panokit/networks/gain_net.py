"""The gain network: how much brighter than white each burnt-out place really is."""

from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from panokit.networks.layers import SphereBlock

WIDTHS = (16, 32, 48, 64, 64)
CODE = 96
# No natural source is more than e^13 times brighter than the white of a picture around it.
HIGHEST_LOG_GAIN = 13.0


class GainNet(nn.Module):
    """A U-net over the 128x64 grid with one code for the whole picture.

    Input: (B, 16, 64, 128), `panokit.expand.features.CHANNELS`.
    Output: log gain of burnt-out light per channel, (B, 3, 64, 128), and the two slopes of
    the response curve, (B, 2), see `panokit.expand.curve`.
    """

    def __init__(self, inputs: int = 16, dropout: float = 0.0) -> None:
        super().__init__()
        sizes = [inputs, *WIDTHS]
        self.down = nn.ModuleList(SphereBlock(a, b) for a, b in pairwise(sizes))
        self.code = nn.Sequential(
            nn.Dropout(dropout), nn.Linear(2 * WIDTHS[-1], CODE), nn.SiLU(), nn.Linear(CODE, CODE)
        )
        upward = list(reversed(WIDTHS))
        self.up = nn.ModuleList(SphereBlock(a + b, b, CODE) for a, b in pairwise(upward))
        self.head = nn.Conv2d(WIDTHS[0], 4, 1)
        self.scalars = nn.Linear(CODE, 3)
        nn.init.zeros_(self.scalars.weight)
        with torch.no_grad():
            # Most burnt-out light is a few times white: start there, with the sRGB curve.
            self.scalars.bias.copy_(torch.tensor([1.5, 0.0, 0.0]))

    def forward(self, grid: Tensor) -> tuple[Tensor, Tensor]:
        """See the class."""
        skips = []
        x = grid
        for level, block in enumerate(self.down):
            x = block(x if level == 0 else F.avg_pool2d(x, 2))
            skips.append(x)
        code = self.code(torch.cat([x.mean(dim=(2, 3)), x.amax(dim=(2, 3))], dim=1))
        for block, skip in zip(self.up, reversed(skips[:-1]), strict=True):
            x = F.interpolate(x, scale_factor=2.0, mode="nearest")
            x = block(torch.cat([x, skip], dim=1), code)
        local = self.head(x)
        scalars = self.scalars(code)
        # Softplus: what is burnt out is never darker than white.
        gain = F.softplus(local[:, :1] + scalars[:, :1, None, None]).clamp(max=HIGHEST_LOG_GAIN)
        log_gain = gain + 0.5 * torch.tanh(local[:, 1:])
        slopes = torch.exp(0.8 * torch.tanh(scalars[:, 1:]))
        return log_gain, slopes


class GainEnsemble(nn.Module):
    """Several gain networks as one: the mean of their log gains and of their slopes' logs."""

    def __init__(self, members: list[GainNet]) -> None:
        super().__init__()
        self.members = nn.ModuleList(members)

    def forward(self, grid: Tensor) -> tuple[Tensor, Tensor]:
        """As `GainNet`."""
        results = [member(grid) for member in self.members]
        log_gain = torch.stack([gain for gain, _ in results]).mean(dim=0)
        slopes = torch.stack([slope for _, slope in results]).log().mean(dim=0).exp()
        return log_gain, slopes

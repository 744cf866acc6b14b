"""Changes to a batch that leave the task the same."""

import torch
from torch import Tensor


def turn(maps: Tensor, columns: list[int], flips: list[bool]) -> Tensor:
    """Each picture of (B, C, H, W) rolled in longitude and, where asked, mirrored."""
    turned = []
    for picture, shift, flip in zip(maps, columns, flips, strict=True):
        rolled = picture.roll(shift, dims=-1)
        turned.append(rolled.flip(-1) if flip else rolled)
    return torch.stack(turned)


def tint(
    grid: Tensor, clear: Tensor, burnt: Tensor, log_color: Tensor
) -> tuple[Tensor, Tensor, Tensor]:
    """Another color of light, (B, 3) logs, for the picture and its truth.

    White stays white in the picture, as it would in a camera; encoded values move by the
    slope of the curve, about 1 / 2.2.
    """
    color = log_color[:, :, None, None]
    share = grid[:, 9:10]
    tinted = grid.clone()
    tinted[:, 0:3] = torch.minimum(
        share + (grid[:, 0:3] - share) * torch.exp(color / 2.2), torch.ones(())
    )
    tinted[:, 3:6] = grid[:, 3:6] * torch.exp(color)
    return tinted, clear + color, burnt + color

"""ExpandNet, the network that panokit's own is measured against.

Marnerides et al. 2018, "ExpandNet: A Deep Convolutional Neural Network for High Dynamic Range
Expansion from Low Dynamic Range Content". Three branches look at a picture: near, farther, and at
all of it squeezed to 256x256; 1x1 convolutions fuse them. Written from the published
description: the same layers, paddings and number of weights (456,899). It knows nothing of the
sphere: its edges see zeros, and turning a panorama changes its answer. Its output is
relative, from 0 to 1 of the brightest value, so a sun leaves little room for the rest.
"""

import torch
from torch import Tensor, nn
from torch.nn import functional as F

GLOBAL_PX = 256
PATCH_PX = 256
# On every side of a patch, dropped after the network: half the published overlap of 20.
MARGIN_PX = 10
COSINE_WEIGHT = 5.0
_COSINE_EPSILON = 1e-20


class ExpandNet(nn.Module):
    """A picture to relative light.

    Input: (B, 3, H, W), RGB, display-encoded, in [0, 1]; any size.
    Output: (B, 3, H, W), linear, in [0, 1] of the brightest value.
    """

    def __init__(self) -> None:
        super().__init__()
        self.local = nn.Sequential(
            nn.Conv2d(3, 64, 3, padding=1), nn.SELU(), nn.Conv2d(64, 128, 3, padding=1), nn.SELU()
        )
        dilated: list[nn.Module] = []
        for step in range(4):
            dilated.append(nn.Conv2d(64 if step else 3, 64, 3, padding=2, dilation=2))
            if step < 3:
                dilated.append(nn.SELU())
        self.dilated = nn.Sequential(*dilated)
        whole: list[nn.Module] = []
        for step in range(6):
            whole += [nn.Conv2d(64 if step else 3, 64, 3, stride=2, padding=1), nn.SELU()]
        whole.append(nn.Conv2d(64, 64, 4))
        self.whole = nn.Sequential(*whole)
        self.fusion = nn.Sequential(
            nn.Conv2d(256, 64, 1), nn.SELU(), nn.Conv2d(64, 3, 1), nn.Sigmoid()
        )

    def forward(self, picture: Tensor) -> Tensor:
        """See the class."""
        return self.expand(picture, self.code(picture))

    def code(self, picture: Tensor) -> Tensor:
        """What the global branch says of the whole picture, (B, 64, 1, 1)."""
        squeezed = F.interpolate(
            picture, size=(GLOBAL_PX, GLOBAL_PX), mode="bilinear", align_corners=False
        )
        return self.whole(squeezed)

    def expand(self, picture: Tensor, code: Tensor) -> Tensor:
        """The light of a picture, or of a part of one, given the `code` of the whole."""
        spread = code.expand(-1, -1, picture.shape[-2], picture.shape[-1])
        return self.fusion(torch.cat([self.local(picture), self.dilated(picture), spread], dim=1))


def predict_by_patches(network: ExpandNet, picture: Tensor) -> Tensor:
    """The network patch by patch with one global code, as published; far less memory.

    Args:
        network: In evaluation mode.
        picture: (B, 3, H, W), any size; zeros go round it.

    Returns:
        (B, 3, H, W), the same as of the whole picture but for what the patches' edges do not see.
    """
    code = network.code(picture)
    height, width = picture.shape[-2:]
    padded = F.pad(picture, [MARGIN_PX] * 4)
    result = torch.empty_like(picture)
    step = PATCH_PX - 2 * MARGIN_PX
    for top in range(0, height, step):
        for left in range(0, width, step):
            patch = padded[..., top : top + PATCH_PX, left : left + PATCH_PX]
            light = network.expand(patch, code)[..., MARGIN_PX:-MARGIN_PX, MARGIN_PX:-MARGIN_PX]
            result[..., top : top + step, left : left + step] = light
    return result


def expandnet_loss(light: Tensor, truth: Tensor) -> Tensor:
    """The published loss: L1 plus 5 (1 - cosine of the colors), both over all pixels.

    Args:
        light: (B, 3, H, W), what the network says.
        truth: (B, 3, H, W), linear, scaled to [0, 1].
    """
    cosine = F.cosine_similarity(light, truth, dim=1, eps=_COSINE_EPSILON)
    return F.l1_loss(light, truth) + COSINE_WEIGHT * (1 - cosine).mean()

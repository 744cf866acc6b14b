"""Networks on reflectance maps: Deep Reflectance Maps and Dematerial, as the thesis rebuilt them.

Deep Reflectance Maps: from a sparse reflectance map to a dense one, or from a picture of the
object to one end to end (Rematas et al. 2016). Dematerial: from the reflectance maps of one or
three materials, and the background, to the environment map (Georgoulis et al. 2017). Both are
made of the thesis's blocks.
"""

import itertools
import math

import torch
from torch import Tensor, nn

from panokit.networks.stereo.blocks import Decode, Encode

_BOTTLENECK_PX = 4


class PictureToMap(nn.Module):
    """An encoder and a decoder: a picture or map in, a 64x64 picture out.

    Args:
        inputs: Channels that go in: 3 for a picture, 4 for a sparse map with its validity.
        input_px: Width and height of what goes in, a power of two.
        output_px: Width and height of what comes out, a power of two.
        width: Features after the first block.
        layers: Convolutions in a block.
    """

    def __init__(
        self, inputs: int, *, input_px: int, output_px: int = 64, width: int = 32, layers: int = 1
    ) -> None:
        super().__init__()
        self.encoder, wide = _encoder(inputs, input_px, width, layers)
        self.decoder = _decoder(wide, output_px, width, layers)

    def forward(self, x: Tensor) -> Tensor:
        """(B, inputs, H, W) to (B, 3, output, output)."""
        return self.decoder(self.encoder(x))


class Dematerial(nn.Module):
    """From sparse reflectance maps and the background to a coded environment map.

    Args:
        materials: How many reflectance maps go in, each through an encoder of its own.
        map_px: Width and height of the reflectance maps.
        background_px: Width and height of the background.
        output_px: Width and height of the environment map.
        width: Features after the first block.
        layers: Convolutions in a block.
    """

    def __init__(
        self,
        *,
        materials: int = 1,
        map_px: int = 64,
        background_px: int = 128,
        output_px: int = 64,
        width: int = 32,
        layers: int = 3,
    ) -> None:
        super().__init__()
        encoders = [_encoder(4, map_px, width, layers) for _ in range(materials)]
        self.maps = nn.ModuleList(encoder for encoder, _ in encoders)
        self.background, behind = _encoder(3, background_px, width, layers)
        wide = sum(count for _, count in encoders) + behind
        self.decoder = _decoder(wide, output_px, width, layers)

    def forward(self, maps: Tensor, background: Tensor) -> Tensor:
        """The coded map of each sample.

        Args:
            maps: (B, 4 materials, map, map): colors and validity of each material; all zero for
                one that is not there.
            background: (B, 3, H, W).
        """
        each = maps.split(4, dim=1)
        encoded = [encode(one) for encode, one in zip(self.maps, each, strict=True)]
        return self.decoder(torch.cat([*encoded, self.background(background)], dim=1))


def _encoder(inputs: int, size: int, width: int, layers: int) -> tuple[nn.Sequential, int]:
    """Blocks down to 4x4, and how many features they end with."""
    count = int(math.log2(size // _BOTTLENECK_PX))
    widths = [inputs] + [min(width * 2**n, 8 * width) for n in range(count)]
    blocks = [Encode(a, b, layers) for a, b in itertools.pairwise(widths)]
    return nn.Sequential(*blocks), widths[-1]


def _decoder(inputs: int, size: int, width: int, layers: int) -> nn.Sequential:
    count = int(math.log2(size // _BOTTLENECK_PX))
    widths = [inputs] + [width * 2 ** (count - 1 - n) for n in range(count)]
    blocks = [Decode(a, b, layers) for a, b in itertools.pairwise(widths)]
    return nn.Sequential(*blocks, nn.Conv2d(widths[-1], 3, 3, padding=1))

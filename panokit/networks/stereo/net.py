"""The stereo network: two encoders, a comparison, fusion, and a decoder to the map.

All configurations of the 2018 thesis (4.3) and some beyond are choices of one network, so that
two of them differ in nothing but what is compared.
"""

import itertools
import math

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from panokit.color.hdr_coding import HdrCoding
from panokit.networks.stereo.blocks import Decode, Encode, WrappedConvolution
from panokit.networks.stereo.coding import decode, encode
from panokit.networks.stereo.lights import LightLobes
from panokit.networks.stereo.settings import ENCODER_BLOCKS, StereoNetSettings
from panokit.networks.stereo.similarity import similarity, similarity_channels
from panokit.networks.stereo.window import BackgroundWindow

_BOTTLENECK_PX = 4


class Encoder(nn.Module):
    """Three encode blocks, each doubling the features and halving the size."""

    def __init__(self, settings: StereoNetSettings) -> None:
        super().__init__()
        widths = [3] + [settings.width * 2**n for n in range(ENCODER_BLOCKS)]
        self.blocks = nn.ModuleList(
            Encode(a, b, settings.layers) for a, b in itertools.pairwise(widths)
        )

    def forward(self, x: Tensor) -> list[Tensor]:
        """(B, 3, H, W) to the features after each block."""
        features = []
        for block in self.blocks:
            x = block(x)
            features.append(x)
        return features


class StereoNet(nn.Module):
    """From two views to a coded environment map.

    Args:
        settings: Which network.
        coding: Of the map; the window and the lights need to know it.
    """

    def __init__(self, settings: StereoNetSettings, coding: HdrCoding | None = None) -> None:
        super().__init__()
        self.settings = settings
        self.coding = coding or HdrCoding()
        self.left = Encoder(settings)
        self.right = Encoder(settings) if settings.weights == "unshared" else None
        self.background = Encoder(settings) if settings.background == "branch" else None
        size = settings.input_px // 2**ENCODER_BLOCKS
        width = settings.width * 2 ** (ENCODER_BLOCKS - 1)
        inputs = 2 * width + self._compared_channels()
        inputs += width if settings.background == "branch" else 0
        # Fusion narrows the picture down to 4x4, whatever its size was.
        halvings = max(0, int(math.log2(size / _BOTTLENECK_PX)))
        fused = 2 * width
        self.fusion = nn.Sequential(
            *(
                Encode(inputs if n == 0 else fused, fused, settings.layers, pool=n < halvings)
                for n in range(ENCODER_BLOCKS)
            )
        )
        self.size = size // 2 ** min(halvings, ENCODER_BLOCKS)
        doublings = int(math.log2(settings.output_px // settings.coarser // self.size))
        widths = [max(settings.width, fused // 2**n) for n in range(doublings + 1)]
        skipped = self._skip_channels() if settings.multi_scale else [0] * doublings
        skipped = (skipped + [0] * doublings)[:doublings]
        self.decoder = nn.ModuleList(
            Decode(a + more, b, settings.layers, wrap=settings.wrap)
            for a, b, more in zip(widths, widths[1:], skipped, strict=False)
        )
        self.dropout = nn.Dropout2d(settings.dropout)
        self.window = self.lobes = None
        if settings.window:
            self.window = BackgroundWindow(settings.fov_deg, settings.output_px, self.coding)
        if settings.lights:
            self.lobes = LightLobes(
                fused * self.size**2, settings.lights, settings.output_px, self.coding.log_max
            )
        # With a window the fourth says how much the background is to be believed.
        outputs = 4 if settings.window else 3
        self.last = (
            WrappedConvolution(widths[-1], outputs)
            if settings.wrap
            else nn.Conv2d(widths[-1], outputs, 3, padding=1)
        )

    def forward(self, left: Tensor, right: Tensor, background: Tensor) -> Tensor:
        """The coded map of each pair.

        Args:
            left: (B, 3, H, W) in [-1, 1]: the object on its background, or on zero, as
                `settings.background` says.
            right: The same of the right view.
            background: (B, 3, H, W) in [-1, 1], the background alone; without a branch and a
                window nothing looks at it.

        Returns:
            (B, 3, output, output) code values, see `panokit.color.hdr_coding`.
        """
        of_left, of_right = self._encode_views(left, right)
        parts = [of_left[-1], of_right[-1]]
        if self.settings.fusion == "similarity":
            parts += self._compare(of_left, of_right)
        if self.background is not None:
            parts.append(self.background(background)[-1])
        fused = x = self.dropout(self.fusion(torch.cat(parts, dim=1)))
        for n, block in enumerate(self.decoder):
            if self.settings.multi_scale and n < ENCODER_BLOCKS:
                early = of_left[ENCODER_BLOCKS - 1 - n]
                x = torch.cat([x, _resized(early, x.shape[-1])], dim=1)
            x = block(x)
        code = _interpolated(self.last(x), self.settings.coarser)
        if self.window is not None:
            seen = self.window(background)
            belief = torch.sigmoid(code[:, 3:].float()) * seen[:, 3:]
            code = belief * seen[:, :3] + (1 - belief) * code[:, :3]
        if self.lobes is None:
            return code
        painted = decode(code.float(), self.coding, most=self.settings.painted)
        return encode(painted + self.lobes(fused.flatten(1)), self.coding)

    def _encode_views(self, left: Tensor, right: Tensor) -> tuple[list[Tensor], list[Tensor]]:
        of_left = self.left(left)
        if self.right is not None:
            return of_left, self.right(right)
        if self.settings.weights == "copy-left" and self.training:
            # The right view's encoder is a copy: no gradient comes through it.
            with torch.no_grad():
                return of_left, self.left(right)
        return of_left, self.left(right)

    def _levels(self) -> list[int]:
        return list(range(ENCODER_BLOCKS)) if self.settings.pyramid else [ENCODER_BLOCKS - 1]

    def _compared_channels(self) -> int:
        if self.settings.fusion == "concat":
            return 0
        return sum(
            similarity_channels(
                self.settings.similarity,
                self._reach(level),
                self.settings.input_px // 2 ** (level + 1),
            )
            for level in self._levels()
        )

    def _reach(self, level: int) -> int:
        """Features are finer on early levels: the same disparity reaches further there."""
        return self.settings.reach * 2 ** (ENCODER_BLOCKS - 1 - level)

    def _compare(self, left: list[Tensor], right: list[Tensor]) -> list[Tensor]:
        size = left[-1].shape[-1]
        compared = []
        for level in self._levels():
            found = similarity(
                left[level], right[level], self.settings.similarity, self._reach(level)
            )
            compared.append(_resized(found, size))
        return compared

    def _skip_channels(self) -> list[int]:
        return [self.settings.width * 2**n for n in reversed(range(ENCODER_BLOCKS))]


def _resized(x: Tensor, size: int) -> Tensor:
    """Features at another size: means over what becomes one, or the nearest when larger."""
    if x.shape[-1] == size:
        return x
    if x.shape[-1] > size:
        return F.avg_pool2d(x, x.shape[-1] // size)
    return F.interpolate(x, size=(size, size), mode="nearest")


def _interpolated(x: Tensor, times: int) -> Tensor:
    """A map so many times larger, linear between pixels, closed in azimuth."""
    if times == 1:
        return x
    # One pixel more on either side, which goes again after it has been interpolated with.
    wide = torch.cat([x[..., -1:], x, x[..., :1]], dim=-1)
    larger = F.interpolate(wide, scale_factor=times, mode="bilinear", align_corners=False)
    return larger[..., times:-times]

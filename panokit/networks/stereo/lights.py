"""A head that says a few lights outright: direction, size, color and strength.

A decoder that is trained on differences of pixels hedges: it paints a wide glow where the sun may
be. A lobe that moves as a whole has somewhere to go.
"""

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional as F

from panokit.sphere import equirect_directions

# Sharpness of a lobe: from 60 degrees wide to a pixel of the 64x64 map.
_SOFTEST, _SHARPEST = 1.0, 400.0
_HIDDEN = 128


class LightLobes(nn.Module):
    """Lobes of light on the sphere, from features.

    A lobe is a spherical Gaussian, `amplitude * exp(sharpness * (cos - 1))` with the cosine of
    the angle to its axis; `panokit.sphere.fit_gaussians` has the same on arrays.

    Args:
        inputs: Features.
        count: Lobes.
        output_px: Width and height of the map.
        log_max: Of the coding: the log of the strongest amplitude.
    """

    directions: Tensor

    def __init__(self, inputs: int, count: int, output_px: int, log_max: float) -> None:
        super().__init__()
        self.count, self.log_max = count, log_max
        self.head = nn.Sequential(
            nn.Linear(inputs, _HIDDEN), nn.ReLU(), nn.Linear(_HIDDEN, 8 * count)
        )
        directions = np.moveaxis(equirect_directions(output_px, output_px), -1, 0)
        self.register_buffer(
            "directions", torch.from_numpy(directions.astype(np.float32)), persistent=False
        )

    def lights(self, features: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """The lobes.

        Args:
            features: (B, inputs).

        Returns:
            Unit directions (B, n, 3) in the left camera's frame, sharpness (B, n) and amplitudes
            (B, n, 3), linear radiance.
        """
        raw = self.head(features).float().view(-1, self.count, 8)
        direction = F.normalize(raw[..., :3] + 1e-4, dim=-1)
        share = torch.sigmoid(raw[..., 3])
        sharpness = _SOFTEST * (_SHARPEST / _SOFTEST) ** share
        strength = torch.sigmoid(raw[..., 4] - 2) * self.log_max
        color = torch.softmax(raw[..., 5:], dim=-1) * 3
        return direction, sharpness, torch.expm1(strength)[..., None] * color

    def forward(self, features: Tensor) -> Tensor:
        """(B, inputs) to the radiance of the lobes, (B, 3, output, output)."""
        direction, sharpness, amplitude = self.lights(features)
        cosine = torch.einsum("bnk,khw->bnhw", direction, self.directions)
        lobe = torch.exp(sharpness[..., None, None] * (cosine - 1))
        return torch.einsum("bnhw,bnc->bchw", lobe, amplitude)

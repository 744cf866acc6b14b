"""The torch twin of `panokit.color.development`: light to pictures, with gradients.

Equal to the numpy camera for the same `Development`, noise included. Rounding to 8 bits passes
gradients straight through. JPEG is not covered: compress with `panokit.color.camera` before
training, or leave it out.
"""

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional as F

from panokit.color.development import (
    LOCAL_MOST,
    LOCAL_PIVOT,
    Development,
    gaussian_kernel,
    noise_field,
)
from panokit.color.luminance import REC709_LUMINANCE
from panokit.color.response import LEAST_SHOULDER, Response
from panokit.errors import UsageError


def develop(radiance: Tensor, developments: Sequence[Development]) -> Tensor:
    """Pictures of maps: (B, 3, H, W), linear, >= 0, to (B, 3, H, W) in [0, 1] in steps of 1/255.

    Args:
        radiance: Of the maps.
        developments: One for each.
    """
    if len(radiance) != len(developments):
        raise UsageError(f"{len(radiance)} maps need as many developments: {len(developments)}.")
    return torch.stack([_develop(*pair) for pair in zip(radiance, developments, strict=True)])


def exposed_percentile(radiance: Tensor, percent: float = 90) -> Tensor:
    """The percentile of luminance over the sphere that exposures are measured by, (B,)."""
    height = radiance.shape[-2]
    edges = torch.cos(torch.linspace(0, torch.pi, height + 1, dtype=torch.float64))
    weights = (edges[:-1] - edges[1:])[:, None].expand(radiance.shape[-2:]).flatten()
    light, order = _luminance(radiance).flatten(1).sort(dim=1)
    reached = weights.to(radiance.device)[order].cumsum(dim=1)
    # A hair below, so that rounding in the last digit does not move on by a pixel.
    target = (percent / 100 * (1 - 1e-12)) * reached[:, -1:]
    index = torch.searchsorted(reached, target).clamp(max=light.shape[1] - 1)
    return light.gather(1, index)[:, 0]


def encode(light: Tensor, response: Response) -> Tensor:
    """Light in [0, 1] to encoded values, any shape; see `panokit.color.response.encode`."""
    if response.family == "srgb":
        curve = 1.055 * light.clamp(min=1e-8) ** (1 / 2.4) - 0.055
        return torch.where(light <= 0.0031308, 12.92 * light, curve)
    # A power of zero has no gradient; what is as dark as this is black in 8 bits.
    safe = light.clamp(min=1e-12)
    if response.family == "sigmoid":
        n, s = response.numbers
        raised = safe**n
        return (1 + s) * raised / (raised + s)
    value = safe ** (1 / response.numbers[0])
    if response.family == "gamma":
        return value
    _, contrast, shoulder = response.numbers
    value = value + contrast * value * (1 - value) * (2 * value - 1)
    return (
        torch.log1p(shoulder * value) / float(np.log1p(shoulder))
        if shoulder > LEAST_SHOULDER
        else value
    )


def _develop(radiance: Tensor, development: Development) -> Tensor:
    light = radiance * development.exposure
    red, blue = development.white_balance
    if (red, blue) != (1.0, 1.0):
        light = light * torch.tensor([red, 1.0, blue]).to(light)[:, None, None]
    if development.has_noise:
        shape = (*light.shape[1:], 3)
        field = torch.from_numpy(noise_field(shape, development.noise_seed)).to(light)
        variance = development.shot_noise**2 * light.clamp(max=4) + development.read_noise**2
        light = (light + variance.clamp(min=1e-20).sqrt() * field.permute(2, 0, 1)).clamp(min=0)
    light = light.clamp(max=1)
    if development.local > 0:
        light = _tone_locally(light, development.local)
    encoded = encode(light, development.response)
    return encoded + (torch.round(encoded * 255) / 255 - encoded).detach()


def _tone_locally(light: Tensor, strength: float) -> Tensor:
    mean = _neighborhood(_luminance(light))
    gain = (mean.clamp(min=1e-4) / LOCAL_PIVOT) ** -strength
    gain = gain.clamp(1, LOCAL_MOST)
    return gain * light / (1 + (gain - 1) * light)


def _neighborhood(values: Tensor) -> Tensor:
    kernel = torch.from_numpy(gaussian_kernel(values.shape[-1])).to(values)
    pad = len(kernel) // 2
    wide = F.pad(values[None, None], (pad, pad, 0, 0), mode="circular")
    tall = F.pad(wide, (0, 0, pad, pad), mode="replicate")
    across = F.conv2d(tall, kernel[None, None, None, :])
    return F.conv2d(across, kernel[None, None, :, None])[0, 0]


def _luminance(light: Tensor) -> Tensor:
    weights = torch.tensor(REC709_LUMINANCE, dtype=light.dtype, device=light.device)
    return torch.einsum("...chw,c->...hw", light, weights)

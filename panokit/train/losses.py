"""What an expansion should get right: the light that scenes receive, then its detail.

All terms compare logs or shares, so that a lamp of 5 and a sun of 50000 weigh alike.
"""

import torch
from torch import Tensor
from torch.nn import functional as F

from panokit.color.luminance import REC709_LUMINANCE
from panokit.expand.features import GRID_WIDTH_PX
from panokit.networks.curve import apply_curve
from panokit.train.normals import NORMALS, irradiance_matrix

# Keeps logs finite where there is no light; in units of the clip level.
_FLOOR = 1e-4


class GridLoss:
    """The loss of a gain network on the 128x64 grid."""

    def __init__(self) -> None:
        matrix = torch.from_numpy(irradiance_matrix(GRID_WIDTH_PX, NORMALS))
        self._matrix = matrix
        self._area = matrix[-1] / matrix[-1].sum()
        self._luminance = torch.tensor(REC709_LUMINANCE, dtype=torch.float32)

    def __call__(
        self, grid: Tensor, log_gain: Tensor, slopes: Tensor, clear: Tensor, burnt: Tensor
    ) -> Tensor:
        """One number.

        Args:
            grid: (B, 16, 64, 128), the network's input.
            log_gain: (B, 3, 64, 128), predicted.
            slopes: (B, 2), predicted.
            clear: (B, 3, 64, 128), log of the true radiance where nothing is burnt out.
            burnt: (B, 3, 64, 128), log of the true radiance of what is burnt out.
        """
        share = grid[:, 9:10]
        open_share = (1 - share).clamp(min=1e-3)
        unburnt = (grid[:, 3:6] / open_share).clamp(0, 1)
        guess_clear = apply_curve(unburnt, slopes) * open_share
        guess_burnt = grid[:, 6:9] * log_gain.exp()
        true_clear, true_burnt = clear.exp(), burnt.exp()
        loss = self._burnt_detail(guess_burnt, true_burnt, share)
        loss = loss + self._clear_detail(guess_clear, true_clear, share)
        guess, true = guess_clear + guess_burnt, true_clear + true_burnt
        loss = loss + 0.1 * sum(
            light_loss(self._project(guess[:, c]), self._project(true[:, c])) for c in range(3)
        )
        return loss + light_loss(
            self._project(self._light(guess)), self._project(self._light(true))
        )

    def _light(self, radiance: Tensor) -> Tensor:
        return torch.einsum("bchw,c->bhw", radiance, self._luminance)

    def _project(self, light: Tensor) -> Tensor:
        return light.flatten(1) @ self._matrix.T

    def _burnt_detail(self, guess: Tensor, true: Tensor, share: Tensor) -> Tensor:
        """Log error of burnt-out light, weighted half by its area and once by its energy."""
        error = ((guess + _FLOOR).log() - (true + _FLOOR).log()).abs().mean(dim=1).flatten(1)
        area = share.flatten(1) * self._area
        energy = self._light(true).flatten(1) * self._area * (share.flatten(1) > 0)
        weight = 0.5 * area / (area.sum(1, keepdim=True) + 1e-6)
        weight = weight + energy / (energy.sum(1, keepdim=True) + 1e-6)
        return (error * weight).sum(dim=1).mean()

    def _clear_detail(self, guess: Tensor, true: Tensor, share: Tensor) -> Tensor:
        error = ((guess + 1e-3).log() - (true + 1e-3).log()).abs().mean(dim=1).flatten(1)
        weight = (1 - share.flatten(1)) * self._area
        return 0.5 * ((error * weight).sum(1) / weight.sum(1).clamp(min=1e-6)).mean()


def light_loss(guess: Tensor, true: Tensor, relative: float = 0.0) -> Tensor:
    """Error of irradiance on 64 normals, of the energy and of the light vector.

    Args:
        guess: (B, 68): 64 irradiances, the light vector, the energy.
        true: The same of the truth.
        relative: How much of the irradiance's error is relative and not of the log, 0 to 1: in
            doubt, a relative error asks for less light, a log error for the median.
    """
    ratio = (guess[:, :NORMALS] + _FLOOR) / (true[:, :NORMALS] + _FLOOR)
    irradiance = ((1 - relative) * ratio.log().abs() + relative * (ratio - 1).abs()).mean(1)
    energy = ((guess[:, 67] + _FLOOR).log() - (true[:, 67] + _FLOOR).log()).abs()
    guess_vector = guess[:, 64:67] / (guess[:, 67:] + _FLOOR)
    true_vector = true[:, 64:67] / (true[:, 67:] + _FLOOR)
    # The added constant keeps the gradient of the length finite where the two agree.
    vector = ((guess_vector - true_vector).square().sum(1) + 1e-6).sqrt()
    return (2 * irradiance + 0.5 * energy + vector).mean()


def component_loss(
    log_gain: Tensor, ldr_energy: Tensor, energy: Tensor, spread: Tensor, vector: Tensor,
    rest: Tensor, relative: float = 0.0,
) -> Tensor:  # fmt: skip
    """The loss of a component network: the light of all components, and each one's own error.

    Args:
        log_gain: (B, K), predicted.
        ldr_energy: (B, K), in the picture; 0 marks padding.
        energy: (B, K), true.
        spread: (B, K, 64), irradiance for an energy of 1.
        vector: (B, K, 3), light vector for an energy of 1.
        rest: (B, 68), irradiance, light vector and energy of all other light.
        relative: See `light_loss`.
    """
    real = (ldr_energy > 0).float()
    guess = ldr_energy * log_gain.exp()
    guess_light, true_light = (
        torch.cat(
            [
                torch.einsum("bk,bkn->bn", each, spread),
                torch.einsum("bk,bkn->bn", each, vector),
                each.sum(dim=1, keepdim=True),
            ],
            dim=1,
        )
        + rest
        for each in (guess, energy * real)
    )
    error = ((guess + 1e-3).log() - (energy + 1e-3).log()).abs() * real
    by_energy = energy * real / (energy * real).sum(1, keepdim=True).clamp(min=1e-6)
    evenly = real / real.sum(1, keepdim=True).clamp(min=1)
    own = (error * (by_energy + 0.5 * evenly)).sum(dim=1).mean()
    return light_loss(guess_light, true_light, relative) + 0.5 * own


def sun_loss(logit: Tensor, sun: Tensor, ldr_energy: Tensor) -> Tensor:
    """Binary cross-entropy of which component is the sun.

    Args:
        logit: (B, K), predicted.
        sun: (B, K), 1 where the component is the sun.
        ldr_energy: (B, K), 0 marks padding.
    """
    real = (ldr_energy > 0).float()
    each = F.binary_cross_entropy_with_logits(logit, sun, reduction="none") * real
    return each.sum(dim=1).mean()

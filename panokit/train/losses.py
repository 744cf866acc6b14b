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

    def to(self, device: str) -> "GridLoss":
        """The same loss for tensors on a device."""
        self._matrix, self._area, self._luminance = (
            tensor.to(device) for tensor in (self._matrix, self._area, self._luminance)
        )
        return self

    def __call__(
        self,
        grid: Tensor,
        log_gain: Tensor,
        slopes: Tensor,
        clear: Tensor,
        burnt: Tensor,
        ceiling: Tensor | None = None,
    ) -> dict[str, Tensor]:
        """The terms by name; their sum is what to make small.

        Args:
            grid: (B, 16, 64, 128), the network's input.
            log_gain: (B, 3, 64, 128), predicted.
            slopes: (B, 2), predicted.
            clear: (B, 3, 64, 128), log of the true radiance where nothing is burnt out.
            burnt: (B, 3, 64, 128), log of the true radiance of what is burnt out.
            ceiling: (B, 64, 128), how much of each cell's truth is a lower bound; nothing if
                not given.
        """
        share = grid[:, 9:10]
        open_share = (1 - share).clamp(min=1e-3)
        unburnt = (grid[:, 3:6] / open_share).clamp(0, 1)
        guess_clear = apply_curve(unburnt, slopes) * open_share
        guess_burnt = grid[:, 6:9] * log_gain.exp()
        true_clear, true_burnt = clear.exp(), burnt.exp()
        cells = torch.zeros_like(share) if ceiling is None else (ceiling[:, None] > 0).float()
        bound = cells.amax(dim=(1, 2, 3))
        guess, true = guess_clear + guess_burnt, true_clear + true_burnt
        color = torch.stack(
            [
                light_loss(self._project(guess[:, c]), self._project(true[:, c]), bound=bound)
                for c in range(3)
            ]
        ).sum()
        return {
            "burnt": self._burnt_detail(guess_burnt, true_burnt, share, cells),
            "clear": self._clear_detail(guess_clear, true_clear, share),
            "color": 0.1 * color,
            "light": light_loss(
                self._project(self._light(guess)), self._project(self._light(true)), bound=bound
            ),
        }

    def _light(self, radiance: Tensor) -> Tensor:
        return torch.einsum("bchw,c->bhw", radiance, self._luminance)

    def _project(self, light: Tensor) -> Tensor:
        return light.flatten(1) @ self._matrix.T

    def _burnt_detail(self, guess: Tensor, true: Tensor, share: Tensor, cells: Tensor) -> Tensor:
        """Log error of burnt-out light, weighted half by its area and once by its energy."""
        difference = (guess + _FLOOR).log() - (true + _FLOOR).log()
        error = _missed(difference, cells).mean(dim=1).flatten(1)
        area = share.flatten(1) * self._area
        energy = self._light(true).flatten(1) * self._area * (share.flatten(1) > 0)
        weight = 0.5 * area / (area.sum(1, keepdim=True) + 1e-6)
        weight = weight + energy / (energy.sum(1, keepdim=True) + 1e-6)
        return (error * weight).sum(dim=1).mean()

    def _clear_detail(self, guess: Tensor, true: Tensor, share: Tensor) -> Tensor:
        error = ((guess + 1e-3).log() - (true + 1e-3).log()).abs().mean(dim=1).flatten(1)
        weight = (1 - share.flatten(1)) * self._area
        return 0.5 * ((error * weight).sum(1) / weight.sum(1).clamp(min=1e-6)).mean()


def light_loss(
    guess: Tensor, true: Tensor, relative: float = 0.0, bound: Tensor | None = None
) -> Tensor:
    """Error of irradiance on 64 normals, of the energy and of the light vector.

    Args:
        guess: (B, 68): 64 irradiances, the light vector, the energy.
        true: The same of the truth.
        relative: How much of the irradiance's error is relative and not of the log, 0 to 1: in
            doubt, a relative error asks for less light, a log error for the median.
        bound: (B,), 1 where the truth is a lower bound: only too little light is an error
            then, and the light vector is not known. Nowhere if not given.
    """
    bound = torch.zeros_like(guess[:, 0]) if bound is None else bound
    ratio = (guess[:, :NORMALS] + _FLOOR) / (true[:, :NORMALS] + _FLOOR)
    one_sided = bound[:, None]
    irradiance = (
        (1 - relative) * _missed(ratio.log(), one_sided) + relative * _missed(ratio - 1, one_sided)
    ).mean(1)
    energy = _missed((guess[:, 67] + _FLOOR).log() - (true[:, 67] + _FLOOR).log(), bound)
    guess_vector = guess[:, 64:67] / (guess[:, 67:] + _FLOOR)
    true_vector = true[:, 64:67] / (true[:, 67:] + _FLOOR)
    # The added constant keeps the gradient of the length finite where the two agree.
    vector = ((guess_vector - true_vector).square().sum(1) + 1e-6).sqrt()
    return (2 * irradiance + 0.5 * energy + (1 - bound) * vector).mean()


def _missed(difference: Tensor, bound: Tensor) -> Tensor:
    """The size of a difference; where `bound` is 1, only of one below zero."""
    return torch.where(bound > 0, (-difference).clamp(min=0), difference.abs())


def component_loss(
    log_gain: Tensor, ldr_energy: Tensor, energy: Tensor, spread: Tensor, vector: Tensor,
    rest: Tensor, lower: Tensor | None = None, relative: float = 0.0,
) -> dict[str, Tensor]:  # fmt: skip
    """The loss of a component network: the light of all components, and each one's own error.

    Args:
        log_gain: (B, K), predicted.
        ldr_energy: (B, K), in the picture; 0 marks padding.
        energy: (B, K), true.
        spread: (B, K, 64), irradiance for an energy of 1.
        vector: (B, K, 3), light vector for an energy of 1.
        rest: (B, 68), irradiance, light vector and energy of all other light.
        lower: (B, K), 1 where the true energy is a lower bound; nowhere if not given.
        relative: See `light_loss`.

    Returns:
        The terms by name; their sum is what to make small.
    """
    lower = torch.zeros_like(energy) if lower is None else lower
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
    error = _missed((guess + 1e-3).log() - (energy + 1e-3).log(), lower) * real
    by_energy = energy * real / (energy * real).sum(1, keepdim=True).clamp(min=1e-6)
    evenly = real / real.sum(1, keepdim=True).clamp(min=1)
    own = (error * (by_energy + 0.5 * evenly)).sum(dim=1).mean()
    bound = lower.amax(dim=1)
    return {"light": light_loss(guess_light, true_light, relative, bound), "own": 0.5 * own}


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

"""How wrong a predicted map is: in its numbers, and in what its light does.

The render loss is the 2018 thesis's own future work (6.2.4): scenes are lit by the predicted map
and the true one through precomputed transport (`panokit.metrics.transport`), which is linear, so
its gradient is one matrix product.
"""

from functools import lru_cache

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional as F

from panokit.color.hdr_coding import HdrCoding
from panokit.metrics.transport import transport
from panokit.networks.stereo.coding import decode, encode
from panokit.sphere import equirect_directions, row_solid_angles
from panokit.train.stereo.recipe import LossRecipe

# What the scenes are lit from: enough for shadows to have edges, small enough for one matrix.
_ACROSS, _DOWN = 32, 16
_SCENES = ("diffuse", "glossy-0.3", "plane")
# So many pixels of each scene stand for all of them.
_PIXELS = 200
# Added to what is divided by or logged: a thousandth of the pictures' white.
_FLOOR = 1e-3
# Of SSIM, for values with a range of 2.
_WINDOW, _C1, _C2 = 7, (0.01 * 2) ** 2, (0.03 * 2) ** 2


class MapLoss:
    """The loss of a predicted environment map.

    Args:
        weights: How much each term counts.
        coding: Of the network's output.
    """

    def __init__(self, weights: LossRecipe, coding: HdrCoding) -> None:
        self._weights = weights
        self._coding = coding

    def __call__(self, code: Tensor, truth: Tensor) -> dict[str, Tensor]:
        """The terms by name, weighted; their sum is what to make small.

        Args:
            code: (B, 3, 64, 64), predicted code values.
            truth: (B, 3, 64, 64), true radiance.
        """
        weights = self._weights
        terms = {"l1": weights.l1 * (code - encode(truth, self._coding)).abs().mean()}
        if weights.dssim == weights.render == weights.energy == weights.direction == 0:
            return terms
        guess = decode(code.float(), self._coding, most=self._coding.brightest)
        if weights.dssim:
            terms["dssim"] = weights.dssim * dssim(guess, truth)
        if weights.render:
            terms["render"] = weights.render * render_difference(guess, truth)
        energy, vector = light_vector(guess)
        true_energy, true_vector = light_vector(truth)
        if weights.energy:
            ratio = ((energy + _FLOOR) / (true_energy + _FLOOR)).log()
            terms["energy"] = weights.energy * ratio.abs().mean()
        if weights.direction:
            away = vector / (energy[:, None] + _FLOOR) - true_vector / (
                true_energy[:, None] + _FLOOR
            )
            terms["direction"] = weights.direction * away.norm(dim=1).mean()
        return terms


def light_vector(radiance: Tensor) -> tuple[Tensor, Tensor]:
    """The energy and the light vector of maps, their channels averaged.

    As `panokit.sphere.energy` and `light_vector`, which take luminance and not the mean.

    Args:
        radiance: (B, 3, H, W), equirectangular, of any aspect.

    Returns:
        (B,) and (B, 3), in the maps' frame: sums of radiance, and of radiance times direction,
        over the sphere.
    """
    gray = radiance.mean(dim=1).flatten(1)
    weights, directions = (part.to(gray) for part in _geometry(*radiance.shape[-2:]))
    weighted = gray * weights
    return weighted.sum(dim=1), weighted @ directions


def dssim(guess: Tensor, truth: Tensor) -> Tensor:
    """The mean of (1 - SSIM) / 2 over windows, channels and pictures (B, 3, H, W).

    The twin of `panokit.metrics.similarity.dssim` with the preset "thesis": windows of 7x7 that
    lie inside the picture, sample covariance, range 2 (Wang et al. 2004, equation 13).
    """
    means, true_means = _windows(guess), _windows(truth)
    sample = _WINDOW**2 / (_WINDOW**2 - 1)
    spread = sample * (_windows(guess**2) - means**2)
    true_spread = sample * (_windows(truth**2) - true_means**2)
    shared = sample * (_windows(guess * truth) - means * true_means)
    alike = (2 * means * true_means + _C1) * (2 * shared + _C2)
    of_both = (means**2 + true_means**2 + _C1) * (spread + true_spread + _C2)
    return ((1 - alike / of_both) / 2).mean()


def _windows(values: Tensor) -> Tensor:
    return F.avg_pool2d(values, _WINDOW, stride=1)


def render_difference(guess: Tensor, truth: Tensor) -> Tensor:
    """The mean |difference| of what the scenes look like, over how bright they are truly.

    Args:
        guess: (B, 3, 64, 64) linear radiance.
        truth: As `guess`.
    """
    seen, true = (_lit(one) for one in (guess, truth))
    return ((seen - true).abs().mean(dim=(1, 2)) / (true.mean(dim=(1, 2)) + _FLOOR)).mean()


def _lit(radiance: Tensor) -> Tensor:
    """(B, 3, 64, 64) radiance to (B, pixels, 3) of the scenes."""
    height, width = radiance.shape[-2:]
    rows = _row_areas(height, width).to(radiance)
    weighted = radiance * rows[:, None]
    batch = len(radiance)
    blocks = weighted.view(batch, 3, _DOWN, height // _DOWN, _ACROSS, width // _ACROSS)
    energy = blocks.sum(dim=(3, 5))
    coarse = _row_areas(_DOWN, _ACROSS).to(radiance)
    mean = (energy / coarse[:, None]).flatten(2)
    return torch.einsum("pd,bcd->bpc", scene_matrix().to(radiance), mean)


@lru_cache(maxsize=1)
def scene_matrix() -> Tensor:
    """(pixels, directions): what each direction's radiance adds to some pixels of each scene."""
    rows = [_matrix_of(scene) for scene in _SCENES]
    return torch.from_numpy(np.concatenate(rows))


def _matrix_of(scene: str) -> NDArray[np.float32]:
    light = transport(scene, _ACROSS)
    count = _ACROSS * _DOWN
    # As many channels as directions, and in each channel light from one of them.
    seen = light.forward(np.eye(count, dtype=np.float32).reshape(_DOWN, _ACROSS, count))
    rows = seen.reshape(-1, count)
    lit = np.flatnonzero(rows.sum(axis=1) > 0)
    matrix = rows[lit[np.linspace(0, len(lit) - 1, min(_PIXELS, len(lit))).astype(int)]]
    # Each scene counts alike, however bright it is.
    return matrix / max(float(matrix.sum(axis=1).mean()), 1e-9)


@lru_cache(maxsize=4)
def _geometry(height: int, width: int) -> tuple[Tensor, Tensor]:
    weights = np.repeat(row_solid_angles(height, width), width)
    directions = equirect_directions(width, height).reshape(-1, 3)
    return torch.from_numpy(weights).float(), torch.from_numpy(np.array(directions)).float()


def _row_areas(height: int, width: int) -> Tensor:
    """The solid angle of a pixel in each row; a copy, since the shared one is read-only."""
    return torch.tensor(row_solid_angles(height, width).tolist())

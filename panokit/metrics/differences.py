"""How far two maps are apart, value by value: the plain figures of protocol "panokit-v1".

Each function takes an estimate and the truth, (H, W, 3) linear radiance in one unit and frame,
and returns one number over all pixels and channels. A pixel counts by its solid angle; with
`weighting="pixel"` each counts the same, which is what most papers print.

Linear errors of HDR maps have heavy tails: one sun pixel of radiance 1525 that is misplaced by
one pixel gives a 64x64 map an MSE of 1135, whatever the rest is like. Give percentiles over
scenes beside a mean (`panokit.metrics.statistics`), and never rank by mean linear MSE alone.
"""

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import angle_between
from panokit.metrics.pairs import Radiance, Weighting, pixel_weights, radiance_pair

LOG_FLOOR = 1e-3
"""Radiance below this part of the truth's mean counts as that part in `log_rmse`."""


def l1(estimate: Radiance, truth: Radiance, *, weighting: Weighting = "solid-angle") -> float:
    """The mean absolute difference."""
    guess, true = radiance_pair(estimate, truth)
    return _mean(np.abs(guess - true), weighting)


def relative_l1(
    estimate: Radiance, truth: Radiance, *, weighting: Weighting = "solid-angle"
) -> float:
    """The mean absolute difference over the truth's mean: 1 is as wrong as a black map.

    NaN if the truth is black.
    """
    guess, true = radiance_pair(estimate, truth)
    whole = _mean(np.abs(true), weighting)
    return _mean(np.abs(guess - true), weighting) / whole if whole > 0 else float("nan")


def mse(estimate: Radiance, truth: Radiance, *, weighting: Weighting = "solid-angle") -> float:
    """The mean squared difference, over pixels and channels."""
    guess, true = radiance_pair(estimate, truth)
    return _mean((guess - true) ** 2, weighting)


def rmse(estimate: Radiance, truth: Radiance, *, weighting: Weighting = "solid-angle") -> float:
    """The root of `mse`."""
    return float(np.sqrt(mse(estimate, truth, weighting=weighting)))


def ssd(estimate: Radiance, truth: Radiance, *, weighting: Weighting = "solid-angle") -> float:
    """The sum of squared differences: `mse` times the number of samples, H x W x 3.

    With `weighting="pixel"` it is the plain sum. It grows with the size of the map, so it
    compares training curves, not papers.
    """
    return mse(estimate, truth, weighting=weighting) * np.asarray(truth).size


def log_rmse(
    estimate: Radiance,
    truth: Radiance,
    *,
    floor: float | None = None,
    weighting: Weighting = "solid-angle",
) -> float:
    """The root mean squared difference of log10 radiance, in decades.

    Args:
        estimate: (H, W, 3), linear.
        truth: (H, W, 3), linear.
        floor: Darker values count as this, in the maps' unit; `LOG_FLOOR` times the truth's
            mean if not given.
        weighting: How much a pixel counts.

    Raises:
        UsageError: If the floor is not above zero, or not given for a black truth.
    """
    guess, true = radiance_pair(estimate, truth)
    lowest = LOG_FLOOR * _mean(true, weighting) if floor is None else floor
    if not lowest > 0:
        raise UsageError(f"Logarithms need a floor above zero, not {lowest}; give one in `floor`.")
    decades = np.log10(np.maximum(guess, lowest)) - np.log10(np.maximum(true, lowest))
    return float(np.sqrt(_mean(decades**2, weighting)))


def si_rmse(
    estimate: Radiance,
    truth: Radiance,
    *,
    per_channel: bool = False,
    weighting: Weighting = "solid-angle",
) -> float:
    """The RMSE after the factor on the estimate that makes it least (Grosse et al. 2009).

    alpha = sum w p t / sum w p^2. A black estimate keeps the factor 0, so it scores the
    truth's root mean square.

    Args:
        estimate: (H, W, 3), linear; its scale does not matter.
        truth: (H, W, 3), linear.
        per_channel: One factor for each channel, which forgives the white balance too.
        weighting: How much a pixel counts.
    """
    guess, true = radiance_pair(estimate, truth)
    weights = pixel_weights(true.shape, weighting)[..., None]
    over = (0, 1) if per_channel else (0, 1, 2)
    power = (weights * guess**2).sum(axis=over)
    shared = (weights * guess * true).sum(axis=over)
    alpha = np.divide(shared, power, out=np.zeros_like(shared), where=power > 0)
    return float(np.sqrt(_mean((alpha * guess - true) ** 2, weighting)))


def psnr_db(
    estimate: Radiance, truth: Radiance, *, peak: float, weighting: Weighting = "solid-angle"
) -> float:
    """10 log10(peak^2 / MSE): infinite for equal maps.

    Args:
        estimate: (H, W, 3), linear.
        truth: (H, W, 3), linear.
        peak: What counts as the largest value. There is no default: a PSNR of HDR maps
            without its declared peak means nothing.
        weighting: How much a pixel counts.

    Raises:
        UsageError: If the peak is not above zero.
    """
    if not peak > 0:
        raise UsageError(f"The peak of a PSNR is above zero, not {peak}.")
    error = mse(estimate, truth, weighting=weighting)
    return float(10 * np.log10(peak**2 / error)) if error > 0 else float("inf")


def rgb_angular_deg(
    estimate: Radiance, truth: Radiance, *, weighting: Weighting = "solid-angle"
) -> float:
    """The mean angle between the colors of both maps as vectors in RGB, in degrees.

    Blind to brightness. A pixel that is black in both says nothing and does not count; one
    that is black in one map only counts as 90 degrees, the widest angle between colors. NaN
    if no pixel counts.
    """
    guess, true = radiance_pair(estimate, truth)
    weights = np.broadcast_to(pixel_weights(true.shape, weighting), true.shape[:2])
    return mean_color_angle_deg(guess, true, weights)


def mean_color_angle_deg(
    colors: NDArray[np.float64], others: NDArray[np.float64], weights: NDArray[np.float64]
) -> float:
    """The weighted mean of RGB angles, by the rule of `rgb_angular_deg`; (..., 3) and (...)."""
    angles = np.degrees(angle_between(colors, others))
    black, other_black = ~colors.any(axis=-1), ~others.any(axis=-1)
    angles = np.where(black | other_black, 90.0, angles)
    counted = np.where(black & other_black, 0.0, weights)
    whole = float(counted.sum())
    return float((angles * counted).sum() / whole) if whole > 0 else float("nan")


def _mean(values: NDArray[np.float64], weighting: Weighting) -> float:
    """The weighted mean over pixels, and the plain one over channels."""
    weights = pixel_weights(values.shape, weighting)
    return float((values.mean(axis=2) * weights).sum())

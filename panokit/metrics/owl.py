"""The scoring of Objects With Lighting: exposure and white balance are fitted before comparing.

Ummenhofer et al. 2024, "Objects With Lighting: A real-world dataset for evaluating
reconstruction and rendering for object relighting" (isl-org/objects-with-lighting,
scripts/evaluate.py and utils/metrics.py). A linear estimate is brought to the tone-mapped truth,
y = clip((x 2^exposure balance)^(1/2.2), 0, 1), by the exposure and then the balance of channels,
each between 0.5 and 2, that make the mean absolute difference least over the object's pixels
that are not overexposed in the truth. Then PSNR and SSIM over the object.

What the "compat" variant keeps:

- The search for the exposure gets the interval from -10 to the exposure at which the darkest
  pixel is white as a *bracket*, which Brent's method may leave, and finds a local minimum.
- The balance is fitted by L-BFGS-B from 1, 1, 1, which may stop at once at a kink of the
  absolute difference.
- The SSIM multiplies both images by the mask first, so windows at the outline compare black with
  black and come out too well.

"fixed" looks for both in intervals, on a grid first; the balance of each channel is a search of
its own, since channels do not mix. Its SSIM counts only windows that lie wholly on the object.
The published docstring says "mean error in linear space"; both variants do what the code does,
absolute error after gamma. LPIPS needs a network and is not here.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize, minimize_scalar

from panokit.errors import ImageError, UsageError
from panokit.metrics.similarity import SsimSettings, ssim_map

Variant = Literal["compat", "fixed"]
Image = NDArray[np.floating[Any]]

_GAMMA = 2.2
_DARKEST_EXPOSURE = -10.0
_BALANCE = (0.5, 2.0)
_GRID_STOPS = 0.25
_SSIM = SsimSettings(window_px=7, sigma_px=None, sample_covariance=True, data_range=1.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OwlScore:
    """A fitted image and how well it fits.

    Attributes:
        image: (H, W, 3) float32, tone-mapped, in [0, 1].
        exposure_stops: What the estimate was exposed by.
        balance: (3,) float64, what its channels were multiplied by.
        psnr_db: Peak 1, over the object; infinite for equal images.
        ssim: Mean over the object.
    """

    image: NDArray[np.float32]
    exposure_stops: float
    balance: NDArray[np.float64]
    psnr_db: float
    ssim: float


def score_owl(
    estimate: Image,
    truth: Image,
    mask: NDArray[Any],
    variant: Variant = "fixed",
    *,
    balance_colors: bool = True,
) -> OwlScore:
    """Fit a linear estimate to a tone-mapped truth and compare them.

    Args:
        estimate: (H, W, 3), linear.
        truth: (H, W, 3), tone-mapped, in [0, 1].
        mask: (H, W), the object: bool, or 0 to 1.
        variant: "compat" or "fixed".
        balance_colors: Fit the channels too, as the benchmark does.

    Raises:
        UsageError: If the variant is not known or shapes do not belong together.
        ImageError: If no pixel can be fitted by, or values are not what they should be.
    """
    if variant not in ("compat", "fixed"):
        raise UsageError(f"The variant is 'compat' or 'fixed', not {variant!r}.")
    linear, shown, inside = _checked(estimate, truth, mask)
    fitted_by = inside & (shown.max(axis=2) < 1)
    pixels, wanted = linear[fitted_by], shown[fitted_by]
    darkest = pixels.min(axis=1) if len(pixels) else np.zeros(0)
    if not (darkest > 0).any():
        raise ImageError(
            "No pixel of the object is lit in the estimate and not overexposed in the truth, so "
            "no exposure can be fitted.",
            reason="nothing-to-fit",
        )
    brightest_exposure = float(np.log2(0.95**_GAMMA / darkest[darkest > 0].min()))
    fit = _published_fit if variant == "compat" else _bounded_fit
    exposure, balance = fit(pixels, wanted, brightest_exposure, balance_colors)
    image = _shown(linear * balance, exposure).astype(np.float32)
    return OwlScore(
        image=image,
        exposure_stops=exposure,
        balance=balance,
        psnr_db=_psnr_db(image[inside], shown[inside]),
        ssim=_ssim(image, shown, inside, variant),
    )


def _checked(
    estimate: Image, truth: Image, mask: NDArray[Any]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    shape = (*np.shape(mask), 3)
    if np.ndim(mask) != 2 or np.shape(estimate) != shape or np.shape(truth) != shape:
        raise UsageError(
            f"A mask is (H, W) and images are (H, W, 3), not {np.shape(mask)}, "
            f"{np.shape(estimate)} and {np.shape(truth)}."
        )
    linear, shown = np.asarray(estimate, np.float64), np.asarray(truth, np.float64)
    if not np.isfinite(shown).all() or shown.min() < 0 or shown.max() > 1:
        raise ImageError(
            "The truth is tone-mapped and lies in [0, 1]; divide 8-bit values by 255.",
            reason="not-tonemapped",
        )
    # As published: what is not finite counts as black.
    linear = np.nan_to_num(linear, posinf=0.0, neginf=0.0)
    return linear, shown, np.asarray(mask, np.float64) > 0.5


def _shown(linear: NDArray[np.float64], exposure: float) -> NDArray[np.float64]:
    raised = np.maximum(linear * 2.0**exposure, 0) ** (1 / _GAMMA)
    return np.asarray(np.clip(raised, 0, 1), np.float64)


def _published_fit(
    pixels: NDArray[np.float64], wanted: NDArray[np.float64], brightest: float, colors: bool
) -> tuple[float, NDArray[np.float64]]:
    def at_exposure(exposure: float) -> float:
        return float(np.abs(_shown(pixels, exposure) - wanted).mean())

    exposure = float(minimize_scalar(at_exposure, (_DARKEST_EXPOSURE, brightest)).x)
    if not colors:
        return exposure, np.ones(3)

    def at_balance(balance: NDArray[np.float64]) -> float:
        return float(np.abs(_shown(pixels * balance, exposure) - wanted).mean())

    found = minimize(at_balance, np.ones(3), bounds=3 * [_BALANCE])
    return exposure, np.asarray(found.x, np.float64)


def _bounded_fit(
    pixels: NDArray[np.float64], wanted: NDArray[np.float64], brightest: float, colors: bool
) -> tuple[float, NDArray[np.float64]]:
    def error(stops: float, channel: slice) -> float:
        shown = _shown(pixels[:, channel], stops)
        return float(np.abs(shown - wanted[:, channel]).mean())

    upper = max(brightest, _DARKEST_EXPOSURE + _GRID_STOPS)
    exposure = _least(lambda stops: error(stops, slice(None)), _DARKEST_EXPOSURE, upper)
    if not colors:
        return exposure, np.ones(3)
    low, high = exposure + np.log2(_BALANCE)
    best = [
        _least(partial(error, channel=slice(channel, channel + 1)), low, high)
        for channel in range(3)
    ]
    return exposure, np.exp2(np.asarray(best, np.float64) - exposure)


def _least(error: Callable[[float], float], low: float, high: float) -> float:
    """Where an error is least between two bounds: the best of a grid, made exact."""
    grid = np.linspace(low, high, int(np.ceil((high - low) / _GRID_STOPS)) + 1)
    best = grid[int(np.argmin([error(float(x)) for x in grid]))]
    step = grid[1] - grid[0]
    bounds = (max(best - step, low), min(best + step, high))
    found = minimize_scalar(error, bounds=bounds, method="bounded", options={"xatol": 1e-6})
    return float(found.x)


def _psnr_db(guess: NDArray[np.float32], true: NDArray[np.float64]) -> float:
    error = float(np.mean((guess - true) ** 2)) if guess.size else float("nan")
    return float(10 * np.log10(1 / error)) if error != 0 else float("inf")


def _ssim(
    guess: NDArray[np.float32],
    true: NDArray[np.float64],
    inside: NDArray[np.bool_],
    variant: Variant,
) -> float:
    counted = inside
    if variant == "fixed":
        window = np.ones((_SSIM.window_px, _SSIM.window_px), np.uint8)
        whole = cv2.erode(inside.astype(np.uint8), window, borderValue=0) > 0
        # An object thinner than the window has no such place.
        counted = whole if whole.any() else inside
    masked = inside[..., None]
    similarity = ssim_map(guess * masked, true * masked, _SSIM)
    return float(similarity[counted].mean())

"""The PSNR of Stanford-ORB, the benchmark of real objects under real light.

Kuang et al. 2023, "Stanford-ORB: A real-world 3D object inverse rendering benchmark"
(StanfordORB/Stanford-ORB, orb/utils/metrics.py and test.py). Linear images are compared on the
object, whose mask is first eroded by 5x5 pixels; one least-squares factor for each channel
removes the ambiguity between light and albedo. Two presets:

- `hdr`: both images are multiplied by the factor that lifts the truth's mean to that of its
  sRGB encoding, then clipped at 4 and compared linearly;
- `ldr`: clipped at 1 and compared in sRGB.

What the "compat" variant keeps:

- The squared error is summed over channels and divided by the number of *pixels* of the mask
  (`divide_by="mask"`, the published function's default), which is 4.77 dB below the usual mean.
  The evaluation script calls the same function with `divide_mask=False`: then the sum is divided
  by all values of the frame (`divide_by="frame"`), so the score of a small object is higher by
  its empty background. Say which one a figure is.
- The result is never lower than that of a mid-grey (0.5) image: bad methods all look alike.
- The peak is 1 even where values reach 4.
- A channel of the estimate that is black gets a factor meant for a white image, and stays black.

"fixed" takes the mean over the mask's pixels and channels, has no floor, and its peak is the
level at which the preset clips. The benchmark's SSIM and LPIPS need networks and are not here.
"""

from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError, UsageError

Variant = Literal["compat", "fixed"]
Preset = Literal["hdr", "ldr"]
Divisor = Literal["mask", "frame"]
Image = NDArray[np.floating[Any]]

_EROSION_PX = 5
_GREY = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class _OrbSettings:
    clip: float
    lift_to_srgb_mean: bool
    encode: bool


_PRESETS: dict[str, _OrbSettings] = {
    "hdr": _OrbSettings(clip=4.0, lift_to_srgb_mean=True, encode=False),
    "ldr": _OrbSettings(clip=1.0, lift_to_srgb_mean=False, encode=True),
}


def orb_psnr_db(
    estimate: Image,
    truth: Image,
    mask: NDArray[Any],
    *,
    preset: Preset = "ldr",
    variant: Variant = "fixed",
    divide_by: Divisor = "mask",
    scale_invariant: bool = True,
) -> float:
    """PSNR by the rules of Stanford-ORB, in dB; see the module.

    Args:
        estimate: (H, W, 3), linear, >= 0.
        truth: (H, W, 3), linear.
        mask: (H, W), the object: bool, or 0 to 1.
        preset: "hdr" or "ldr".
        variant: "compat" or "fixed".
        divide_by: What a "compat" error is divided by; "fixed" has one answer.
        scale_invariant: Fit the factors, as the benchmark does.

    Raises:
        UsageError: If a name is not known or the shapes do not belong together.
        ImageError: If the estimate has negative or infinite values, or the mask is empty once
            it is eroded.
    """
    if preset not in _PRESETS or variant not in ("compat", "fixed"):
        raise UsageError(f"There is no preset {preset!r} in a variant {variant!r}.")
    if divide_by not in ("mask", "frame"):
        raise UsageError(f"An error is divided by 'mask' or 'frame', not {divide_by!r}.")
    settings = _PRESETS[preset]
    inside = eroded_mask(mask)
    guess, true = _on_object(estimate, truth, inside)
    if settings.lift_to_srgb_mean:
        shown = np.clip(true, 0, 1)
        if shown.mean() > 1e-8:
            lift = _srgb(shown).mean() / shown.mean()
            guess, true = guess * lift, true * lift
    if scale_invariant:
        guess = guess * _factors(guess[inside], true[inside], variant)
    guess, true = np.clip(guess, 0, settings.clip), np.clip(true, 0, settings.clip)
    if settings.encode:
        guess, true = _srgb(guess), _srgb(true)
    squared = (guess - true) ** 2
    if variant == "fixed":
        return _db(float(squared[inside].mean()), settings.clip)
    grey = (_GREY * inside[..., None] - true) ** 2
    samples = inside.sum() if divide_by == "mask" else true.size
    return max(_db(float(e.sum()) / float(samples), 1.0) for e in (squared, grey))


def eroded_mask(mask: NDArray[Any]) -> NDArray[np.bool_]:
    """The object without a margin of two pixels, (H, W) bool; the frame's edge is no margin.

    Raises:
        ImageError: If nothing is left.
    """
    if np.ndim(mask) != 2:
        raise UsageError(f"A mask is (H, W), not {np.shape(mask)}.")
    levels = np.clip(np.asarray(mask, np.float32) * 255, 0, 255).astype(np.uint8)
    inside = cv2.erode(levels, np.ones((_EROSION_PX, _EROSION_PX), np.uint8)) > 127
    if not inside.any():
        raise ImageError(
            "No pixel of the object is left once its mask is eroded by 5x5 pixels. Check the "
            "mask, or use larger images.",
            reason="empty-mask",
        )
    return np.asarray(inside)


def _on_object(
    estimate: Image, truth: Image, inside: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    shape = (*inside.shape, 3)
    if np.shape(estimate) != shape or np.shape(truth) != shape:
        raise UsageError(
            f"Images are {shape} like the mask, not {np.shape(estimate)} and {np.shape(truth)}."
        )
    guess, true = (np.asarray(image, np.float64) * inside[..., None] for image in (estimate, truth))
    if not np.isfinite(guess).all() or not np.isfinite(true).all() or (guess < 0).any():
        raise ImageError(
            "Linear images of an object are finite and the estimate is not negative.",
            reason="not-linear",
        )
    return guess, np.maximum(true, 0)


def _factors(
    guess: NDArray[np.float64], true: NDArray[np.float64], variant: Variant
) -> NDArray[np.float64]:
    """The least-squares factor of each channel, (3,)."""
    power = (guess**2).sum(axis=0)
    shared = (guess * true).sum(axis=0)
    if variant == "compat":
        return np.asarray(np.divide(shared, power, out=true.mean(axis=0), where=power > 1e-6))
    return np.asarray(np.divide(shared, power, out=np.zeros(3), where=power > 0))


def _srgb(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """The published encoding; unlike `panokit.color.srgb_encode`, it does not clip at 1."""
    curve = 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055
    return np.asarray(np.where(linear > 0.0031308, curve, 12.92 * linear), np.float64)


def _db(error: float, peak: float) -> float:
    return float(10 * np.log10(peak**2 / error)) if error > 0 else float("inf")

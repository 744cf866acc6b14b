"""The three-sphere protocol: how far renders of a mirror, a matte and a diffuse sphere differ.

Introduced with StyleLight (Wang et al. 2022; evaluation/fast_rmse.py and tonemap.py of
Wanggcong/StyleLight) and used unchanged by DiffusionLight (Phongthawee et al. 2024;
DiffusionLight-evaluation, stylelight/). The published steps:

1. Average the map to 256x128 pixels.
2. Raise it to 1/2.4 and scale it so that the median of its values above zero becomes 0.5. The
   result, not clipped, is used *as the light*.
3. Render three spheres with Blender Cycles: mirror, matte silver, and "diffuse".
4. Compare each render with that of the true map, where alpha is above zero.
5. Average over the scenes (289 maps of Laval Indoor in the paper).

`lighting_of_spheres` is steps 1 and 2, `sphere_errors` is step 4; with renders from the published
Blender scenes between them, the figures are the published protocol's. For renders without
Blender see `panokit.metrics.relit`; those are panokit's, not StyleLight's, and are never to be
put into one table with them.

What the "compat" variant keeps, because the published figures contain it:

- The light is gamma-compressed: a sun 10,000 times as bright as the sky lights the sphere 46
  times as strongly. "fixed" renders linear light, brought to one exposure by its median.
- RMSE divides the sum over three channels by the number of pixels, so it is sqrt(3) = 1.73
  times the RMSE of a channel; si-RMSE as well. "fixed" divides by pixels times channels.
- The normalized RMSE subtracts the 0.01 percentile and divides by the distance to the 99.9
  percentile: 0.01 %, where 0.1 % must have been meant, and over the whole frame, so that the
  transparent zeros round the sphere set the lower end. "fixed" takes 0.1 and 99.9 percent of
  the values on the sphere.
- An angle that is not a number, because a pixel is black, counts as 0, a perfect color; cosines
  that rounding makes larger than 1 are clipped. "fixed" leaves out what is black in both, and
  counts what is black in one of them as 90 degrees.
- The mask is the estimate's alpha above zero, so a pixel that the sphere touches by a
  hundredth counts whole. "fixed" weighs by the truth's alpha.

Not to be mended here, but to be known: the scripts do not turn the map to the camera (Blender
shows u = 0.75 in the middle of the mirror sphere); Cycles runs with 5 samples and a denoiser, so
scores depend on its version; sockets renamed in Blender 4.0 stop the scripts there; and the
"diffuse" sphere is a glossy plastic (roughness 0.364, specular 0.5), not a Lambertian one. A
helper of the repository that turns RGB to intensity weighs red twice and blue not at all; no
score goes through it.
"""

from dataclasses import asdict, dataclass
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance, weighted_percentile
from panokit.errors import ImageError, UsageError
from panokit.metrics.differences import mean_color_angle_deg
from panokit.metrics.pairs import Radiance, check_radiance
from panokit.sphere.resample import resize_radiance
from panokit.sphere.solid_angle import row_solid_angles

Variant = Literal["compat", "fixed"]
Render = NDArray[np.floating[Any]]

WIDTH_PX, HEIGHT_PX = 256, 128
_GAMMA = 2.4
_MEDIAN_TO = 0.5
_LOW_PERCENT = {"compat": 0.01, "fixed": 0.1}
_HIGH_PERCENT = 99.9


@dataclass(frozen=True, slots=True, kw_only=True)
class SphereErrors:
    """How far a render is from that under the true light; 0 is equal for all of them.

    Attributes:
        rmse: Root mean squared difference.
        si_rmse: The same after the one factor on the estimate that makes it least.
        angular_deg: Mean angle between RGB colors.
        normalized_rmse: RMSE after each image is stretched between its own percentiles.
    """

    rmse: float
    si_rmse: float
    angular_deg: float
    normalized_rmse: float

    def to_json(self) -> dict[str, float]:
        """A dictionary for `json.dump`."""
        return asdict(self)


def lighting_of_spheres(radiance: Radiance, variant: Variant = "fixed") -> NDArray[np.float32]:
    """The map that lights the spheres: resized and brought to one exposure.

    Args:
        radiance: (H, W, 3), linear, 2:1.
        variant: "compat" averages pixels and compresses by 1/2.4, as published; "fixed" keeps
            energy and linear light, and takes the median of luminance over the sphere.

    Returns:
        (128, 256, 3) float32.

    Raises:
        UsageError: If the variant is not known.
        ImageError: If it is not a spherical picture of finite radiance, or, for "fixed", black.
    """
    _check_variant(variant)
    check_radiance(np.asarray(radiance))
    pixels = np.asarray(radiance, np.float32)
    if variant == "compat":
        if pixels.shape[:2] != (HEIGHT_PX, WIDTH_PX):
            size = (WIDTH_PX, HEIGHT_PX)
            pixels = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.float32)
        return _published_tone(pixels)
    small = resize_radiance(pixels, WIDTH_PX)
    light = luminance(small)
    weights = row_solid_angles(HEIGHT_PX, WIDTH_PX)[:, None] * (light > 0)
    if not weights.any():
        raise ImageError(
            "A black map lights no sphere; leave the scene out of the test set.",
            reason="black-map",
        )
    median = weighted_percentile(light, weights, 50)
    return np.asarray(small * np.float32(_MEDIAN_TO / median), np.float32)


def sphere_errors(estimate: Render, truth: Render, variant: Variant = "fixed") -> SphereErrors:
    """Compare a render under the estimated light with that under the true light.

    Args:
        estimate: (H, W, 4): linear RGB as the renderer wrote it, and alpha.
        truth: As `estimate`, of the same size.
        variant: "compat" is the published arithmetic, in the dtype of the renders.

    Raises:
        UsageError: If the variant is not known or the shapes differ.
        ImageError: If alpha is zero everywhere, or a value is not finite.
    """
    _check_variant(variant)
    estimate, truth = _render_pair(estimate, truth)
    compare = _published_errors if variant == "compat" else _corrected_errors
    return compare(estimate, truth)


def _published_tone(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    raised = np.power(radiance, 1 / _GAMMA)
    above = raised > 0
    median = np.percentile(raised[above] if above.any() else raised, 50)
    toned = np.multiply(_MEDIAN_TO / (median + 1e-10), raised)
    return np.asarray(toned, np.float32)


def _published_errors(estimate: Render, truth: Render) -> SphereErrors:
    mask = (estimate[..., 3] > 0).astype(np.float64)
    count = mask.sum()
    p, g = estimate[..., :3], truth[..., :3]
    inside = mask[..., None]
    a, b, c = (p**2 * inside).sum(), -(2 * p * g * inside).sum(), (g**2 * inside).sum()
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = (g * p).sum(axis=2) / (np.linalg.norm(g, axis=2) * np.linalg.norm(p, axis=2))
        angles = np.nan_to_num(np.arccos(np.clip(cosine, 0, 1)) * mask)
        least = (4 * a * c - b**2) / (4 * a)
        stretched = (_stretched(p, p, "compat") - _stretched(g, g, "compat")) ** 2
        return SphereErrors(
            rmse=float(np.sqrt(((p - g) ** 2 * inside).sum() / count)),
            # Rounding may leave a hair below zero for equal renders.
            si_rmse=float(np.sqrt(max(least, 0.0) / count)),
            angular_deg=float(np.degrees(angles.sum() / count)),
            normalized_rmse=float(np.sqrt((stretched * inside).sum() / count)),
        )


def _corrected_errors(estimate: Render, truth: Render) -> SphereErrors:
    weights = np.asarray(truth[..., 3], np.float64) / float(truth[..., 3].sum(dtype=np.float64))
    p, g = np.asarray(estimate[..., :3], np.float64), np.asarray(truth[..., :3], np.float64)
    inside = truth[..., 3] > 0

    def rms(difference: NDArray[np.float64]) -> float:
        return float(np.sqrt(((difference**2).mean(axis=2) * weights).sum()))

    power = float((p**2 * weights[..., None]).sum())
    alpha = float((p * g * weights[..., None]).sum()) / power if power > 0 else 0.0
    with np.errstate(invalid="ignore", divide="ignore"):
        stretched = _stretched(p, p[inside], "fixed") - _stretched(g, g[inside], "fixed")
    return SphereErrors(
        rmse=rms(p - g),
        si_rmse=rms(alpha * p - g),
        angular_deg=mean_color_angle_deg(p, g, weights),
        normalized_rmse=rms(np.where(inside[..., None], stretched, 0)),
    )


def _stretched(image: Render, values: Render, variant: Variant) -> Render:
    low = np.percentile(values, _LOW_PERCENT[variant])
    high = np.percentile(values, _HIGH_PERCENT)
    return np.asarray((image - low) / (high - low))


def _render_pair(estimate: Render, truth: Render) -> tuple[Render, Render]:
    estimate, truth = np.asarray(estimate), np.asarray(truth)
    if estimate.shape != truth.shape or estimate.ndim != 3 or estimate.shape[2] != 4:
        raise UsageError(
            f"Renders to compare are both (H, W, 4) with alpha, not {estimate.shape} and "
            f"{truth.shape}. Render with a transparent background."
        )
    for render in (estimate, truth):
        if not np.issubdtype(render.dtype, np.floating):
            raise ImageError(
                f"Renders to compare are linear floating point, not {render.dtype}. Render to EXR.",
                reason="wrong-dtype",
            )
        if not np.isfinite(render).all():
            raise ImageError("A render holds values that are not finite.", reason="not-finite")
        if not (render[..., 3] > 0).any():
            raise ImageError("Alpha is zero everywhere: nothing is rendered.", reason="empty-mask")
    return estimate, truth


def _check_variant(variant: str) -> None:
    if variant not in ("compat", "fixed"):
        raise UsageError(f"The variant is 'compat' or 'fixed', not {variant!r}.")

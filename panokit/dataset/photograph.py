"""The picture a camera makes of a rendered object: background, exposure, whether it is usable."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.dataset.scene import ViewPasses
from panokit.errors import ImageError
from panokit.sphere import resize_radiance

# What a camera's meter brings the mean to.
_MIDDLE_GRAY = 0.18
_LEAST_MASK = 0.02
_MOST_BURNT = 0.4
_LEAST_MEDIAN = 0.004


def blurred_background(radiance: NDArray[np.float32], blur_deg: float) -> NDArray[np.float32]:
    """The map at a resolution at which a pixel is `blur_deg` wide, as behind a shallow lens."""
    if blur_deg <= 0:
        return radiance
    width = 2 * max(8, round(180.0 / blur_deg))
    return resize_radiance(radiance, min(width, radiance.shape[1]))


def metered_exposure(composite: NDArray[np.floating], coverage: NDArray[np.floating]) -> float:
    """By what to multiply radiance so that a picture is exposed as a camera would expose it.

    The mean of the log of luminance becomes middle gray, the object counting as much as all
    that is behind it (Reinhard et al. 2002, "Photographic tone reproduction", equation 1).
    """
    light = luminance(composite)
    floor = 1e-4 * float(light.mean()) + 1e-12
    logs = np.log(np.maximum(light, floor))
    on, off = coverage, 1 - coverage
    parts = [float((logs * w).sum() / w.sum()) for w in (on, off) if w.sum() > 0]
    return float(_MIDDLE_GRAY / np.exp(np.mean(parts)))


def composite_over(one: ViewPasses, behind: NDArray[np.float32]) -> NDArray[np.float32]:
    """The object over its background, and its shadow on a floor."""
    seen = behind if one.shadow is None else behind * one.shadow
    return one.radiance + (1 - one.coverage)[..., None] * seen


def check_pictures(
    passes: Sequence[ViewPasses], composites: Sequence[NDArray[np.float32]], exposure: float
) -> dict[str, float]:
    """The figures of a sample, if it is usable.

    Raises:
        ImageError: If it is not.
    """
    if not all(np.isfinite(one).all() for one in (*composites, *(p.radiance for p in passes))):
        raise ImageError("The renderer gave values that are not finite.", reason="not-finite")
    mask = min(float(one.coverage.mean()) for one in passes)
    if mask < _LEAST_MASK:
        raise ImageError(
            f"The object covers {mask:.1%} of a view.", reason="blank-mask",
            values={"mask_share": mask},
        )  # fmt: skip
    seen = passes[0].coverage > 0.5
    light = luminance(composites[0])[seen] * exposure
    figures = {
        "mask_share": mask,
        "burnt_share": float((light >= 1).mean()),
        "object_median": float(np.median(light)),
    }
    if figures["burnt_share"] > _MOST_BURNT:
        raise ImageError(
            f"{figures['burnt_share']:.0%} of the object is burnt out.",
            reason="over-exposed", values=figures,
        )  # fmt: skip
    if figures["object_median"] < _LEAST_MEDIAN:
        raise ImageError("The object is in the dark.", reason="under-exposed", values=figures)
    return figures

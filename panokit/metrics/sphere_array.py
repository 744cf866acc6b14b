"""The protocol of nine spheres on a plane: whole renders compared, shadows included.

Weber et al. 2022, "Editable indoor lighting estimation", in the form that
DiffusionLight-evaluation published (editableindoor/res1_table.py): Blender renders an array of
nine spheres of different roughness on a plane under each map, linear EXR, and the whole frame is
compared, with no mask. The figure of a method is the *median* over scenes.

What the "compat" variant keeps:

- All arithmetic is float32. Where two colors are equal, rounding can make their cosine larger
  than 1, its arc cosine not a number, and the pixel is dropped: perfect pixels leave the mean.
- So are black pixels of the truth; a black pixel of the estimate counts as not a number as well,
  and so costs nothing. "fixed" leaves out what is black in both and counts what is black in one
  as 90 degrees.
- The peak of the PSNR is the largest value of either image, so one wrong firefly in the
  estimate improves its score. "fixed" takes the truth's.
- Equal images have a PSNR of 100. "fixed" says infinite.

The published script also appends each si-RMSE twice, which does not move a median.
"""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from math import log10
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError, UsageError
from panokit.metrics.differences import mean_color_angle_deg

Variant = Literal["compat", "fixed"]
Render = NDArray[np.floating[Any]]

_PANEL_PERCENT, _PANEL_LEVEL, _PANEL_GAMMA = 90, 0.8, 2.2


@dataclass(frozen=True, slots=True, kw_only=True)
class ArrayErrors:
    """How far a render of the array is from that under the true light.

    Attributes:
        rmse: Root of the mean squared difference over pixels and channels.
        si_rmse: The same after the one factor on the estimate that makes it least.
        angular_deg: Mean angle between RGB chromaticities.
        psnr_db: 20 log10(peak / RMSE).
    """

    rmse: float
    si_rmse: float
    angular_deg: float
    psnr_db: float

    def to_json(self) -> dict[str, float | None]:
        """A dictionary for `json.dump`; what is not finite becomes None."""
        return {name: value if np.isfinite(value) else None for name, value in asdict(self).items()}


def array_errors(estimate: Render, truth: Render, variant: Variant = "fixed") -> ArrayErrors:
    """Compare two renders of the array, each (H, W, 3) linear; a fourth channel is left out.

    Raises:
        UsageError: If the variant is not known or the shapes differ.
        ImageError: If a value is not finite, or the renders are not floating point.
    """
    if variant not in ("compat", "fixed"):
        raise UsageError(f"The variant is 'compat' or 'fixed', not {variant!r}.")
    for render in (estimate, truth):
        _check_render(np.asarray(render))
    p, g = (_colors(np.asarray(render), variant) for render in (estimate, truth))
    if p.shape != g.shape:
        raise UsageError(f"Renders to compare are of one size, not {p.shape} and {g.shape}.")
    rmse = _rms(g - p)
    flat_p, flat_g = p.ravel(), g.ravel()
    power = np.dot(flat_p, flat_p)
    alpha = np.dot(flat_g, flat_p) / power if power > 0 else power
    return ArrayErrors(
        rmse=float(rmse),
        si_rmse=float(_rms(g - p * alpha)),
        angular_deg=_published_angle(p, g) if variant == "compat" else _angle(p, g),
        psnr_db=_psnr_db(p, g, rmse, variant),
    )


def median_array_errors(scenes: Iterable[ArrayErrors]) -> ArrayErrors:
    """The figure that tables print: the median over scenes, score by score.

    Raises:
        UsageError: If there is no scene.
    """
    rows = [asdict(scene) for scene in scenes]
    if not rows:
        raise UsageError("A median needs at least one scene.")
    return ArrayErrors(
        **{name: float(np.nanmedian([row[name] for row in rows])) for name in rows[0]}
    )


def display_panel(render: Render) -> NDArray[np.uint8]:
    """A render as the published figures show it, (H, W, 3) uint8.

    The 90th percentile of all values becomes 0.8, then gamma 2.2; values are cut off, not
    rounded, as published.
    """
    _check_render(np.asarray(render))
    linear = np.asarray(render)[..., :3]
    exposed = linear * (_PANEL_LEVEL / (np.percentile(linear, _PANEL_PERCENT) + 1e-10))
    encoded = np.clip(np.power(np.maximum(exposed, 0), 1 / _PANEL_GAMMA), 0, 1)
    return np.asarray(encoded * 255, np.uint8)


def _colors(render: Render, variant: Variant) -> Render:
    return render[..., :3].astype(np.float32 if variant == "compat" else np.float64)


def _rms(difference: NDArray[np.floating[Any]]) -> Any:
    """As a NumPy scalar in the dtype of the renders, which the published PSNR divides by."""
    return np.sqrt(np.mean(np.power(difference, 2)))


def _published_angle(p: Render, g: Render) -> float:
    with np.errstate(invalid="ignore", divide="ignore"):
        true = np.asarray(g / g.sum(axis=2, keepdims=True), np.float64)
        guess = np.asarray(p / (p.sum(axis=2, keepdims=True) + 1e-8), np.float64)
        norms = np.sqrt((true * true).sum(axis=2)) * np.sqrt((guess * guess).sum(axis=2))
        angles = np.arccos((true * guess).sum(axis=2) / norms)
    angles = angles[~np.isnan(angles)]
    return float(np.mean(angles) * 180 / np.pi) if angles.size else float("nan")


def _angle(p: Render, g: Render) -> float:
    weights = np.ones(p.shape[:2])
    return mean_color_angle_deg(np.asarray(p, np.float64), np.asarray(g, np.float64), weights)


def _psnr_db(p: Render, g: Render, rmse: Any, variant: Variant) -> float:
    if rmse == 0:
        return 100.0 if variant == "compat" else float("inf")
    peak = max(g.max(), p.max()) if variant == "compat" else g.max()
    return float(20 * log10(peak / rmse)) if peak > 0 else float("-inf")


def _check_render(render: NDArray[Any]) -> None:
    if render.ndim != 3 or render.shape[2] not in (3, 4) or 0 in render.shape:
        raise ImageError(
            f"A render of the array is (H, W, 3), not {render.shape}.", reason="wrong-channels"
        )
    if not np.issubdtype(render.dtype, np.floating) or not np.isfinite(render).all():
        raise ImageError(
            "A render of the array holds finite floating point values. Render to EXR.",
            reason="not-linear",
        )

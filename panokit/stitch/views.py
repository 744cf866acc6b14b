"""Overlapping views with known poses to one panorama: exposure, pose, blend.

The order matters: gains are found on the poses as given, poses on evened-out views, and the
gains once more on the better poses. All of it in linear light; bytes are decoded and encoded
with sRGB, floats are taken as they are.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import View
from panokit.color import srgb_decode_u8, srgb_encode_u8
from panokit.errors import ImageError, UsageError
from panokit.stitch.agreement import Agreement, check_agreement
from panokit.stitch.blend import blend_bands, blend_feather, view_weights
from panokit.stitch.layout import scaled
from panokit.stitch.overlaps import (
    CLIPPED_CODE,
    Picture,
    radius_squared,
    sample_overlaps,
    thumbnail,
)
from panokit.stitch.photometry import Photometry, fit_photometry
from panokit.stitch.refine import refine_poses, stage_sizes
from panokit.stitch.settings import StitchSettings

_THUMBNAIL_PX, _GRID_PX = 64, 128
# A clipped pixel says "at least this bright"; where another view is not clipped it yields.
_CLIPPED_WEIGHT = 1e-4
_EVEN = 1.02
_MOST_VIEWS = 2000
_RIGHT_DEG = 0.06


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StitchedViews:
    """A panorama of views.

    Attributes:
        pixels: (H, W, 3), uint8 or float32 as the views were; 0 where not valid.
        valid: (H, W) bool, or None if all is.
        views: With the poses that were used.
        values: What was found out, as JSON values.
    """

    pixels: Picture
    valid: NDArray[np.bool_] | None
    views: tuple[View, ...]
    values: dict[str, Any] = field(default_factory=dict)


def stitch_views(
    pictures: Sequence[Picture],
    views: Sequence[View],
    width_px: int,
    settings: StitchSettings | None = None,
) -> StitchedViews:
    """Blend overlapping views of one place into a panorama.

    Args:
        pictures: (h, w, 3) each, all uint8 (sRGB) or all float32 (linear, >= 0).
        views: Where each looks; in the same order.
        width_px: Of the panorama, even.
        settings: Blend, exposure and refinement; the defaults if not given.

    Raises:
        UsageError: If pictures and views do not go together.
        ImageError: If the views contradict each other ("views-disagree"), or a float picture
            is not finite ("not-physical").
    """
    settings = settings or StitchSettings()
    _check(pictures, views, width_px)
    views = tuple(views)
    photometry, agreement, refined = Photometry.none(len(views)), None, None
    if len(views) > 1 and (settings.exposure or settings.refine != "none"):
        small = [thumbnail(p, v, _THUMBNAIL_PX) for p, v in zip(pictures, views, strict=True)]
        samples = sample_overlaps(small, _GRID_PX)
        agreement = check_agreement(small, samples)
        if settings.exposure:
            photometry = fit_photometry(samples)
        if _wants_refining(settings.refine, agreement):
            given = views
            stages = (
                (
                    small
                    if size == _THUMBNAIL_PX
                    else [thumbnail(p, v, size) for p, v in zip(pictures, given, strict=True)],
                    grid,
                    steps,
                )
                for size, grid, steps in stage_sizes()
            )
            least_deg = _RIGHT_DEG if settings.refine == "auto" else 0.0
            refined = refine_poses(views, stages, photometry, least_deg=least_deg)
            views = refined.views
            if settings.exposure and refined.moved_deg.any():
                posed = [replace(s, view=_at(s.view, v)) for s, v in zip(small, views, strict=True)]
                photometry = fit_photometry(sample_overlaps(posed, _GRID_PX))
    color, valid = _blended(pictures, views, width_px, settings.blend, photometry)
    if pictures[0].dtype == np.uint8:
        pixels: Picture = _encoded(color)
    else:
        pixels = color
    pixels[~valid] = 0
    values: dict[str, Any] = {
        "views": len(views),
        "coverage": round(_covered(valid), 4),
        "blend": settings.blend,
        "gains": np.round(photometry.gain.mean(axis=-1), 4).tolist(),
        "falloff": [round(a, 4) for a in photometry.falloff],
        "views_without_overlap": np.flatnonzero(~photometry.matched).tolist()
        if settings.exposure
        else [],
    }
    if agreement is not None:
        values["agreement"] = round(agreement.score, 3)
    if refined is not None:
        values["pose_moved_deg"] = np.round(refined.moved_deg, 4).tolist()
    return StitchedViews(
        pixels=pixels, valid=None if valid.all() else valid, views=views, values=values
    )


def width_for_views(views: Sequence[View], most_px: int | None) -> int:
    """The width at which no view loses detail at its center, at most `most_px`; even."""
    finest = max(view.width_px / 2 / np.tan(np.deg2rad(view.fov_deg) / 2) for view in views)
    native = int(finest * 2 * np.pi)
    # A multiple of 64, so that the bands of the blend can be halved.
    width = max(64, native // 64 * 64)
    return width if most_px is None else min(width, most_px)


def _wants_refining(choice: str, agreement: Agreement) -> bool:
    return choice == "always" or (choice == "auto" and agreement.pairs > 0)


def _at(small: View, view: View) -> View:
    return scaled(view, small.width_px, small.height_px)


def _blended(
    pictures: Sequence[Picture],
    views: Sequence[View],
    width_px: int,
    blend: str,
    photometry: Photometry,
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    uneven = float(np.ptp(np.log(photometry.gain))) > np.log(_EVEN)
    uneven = uneven or abs(sum(photometry.falloff)) > np.log(_EVEN)
    factors: dict[Any, NDArray[np.float32]] = {}

    def weighted(number: int) -> NDArray[np.float32]:
        view = views[number]
        key = (view.width_px, view.height_px, view.masked_px)
        if key not in factors:
            factors[key] = _factor(view, photometry)
        return _weighted(pictures[number], photometry.gain[number], factors[key], uneven)

    blended = blend_bands if blend == "bands" else blend_feather
    return blended(weighted, views, width_px)


def _factor(view: View, photometry: Photometry) -> NDArray[np.float32]:
    """(h, w, 4): the weight of each pixel over what the lens passes there, and the weight."""
    weights = view_weights(view.width_px, view.height_px, view.masked_px)
    factor = weights / photometry.passes(_radii(view.width_px, view.height_px))
    return np.asarray(cv2.merge([factor, factor, factor, weights]), np.float32)


@lru_cache(maxsize=4)
def _radii(width_px: int, height_px: int) -> NDArray[np.float32]:
    view = View(name="", heading_deg=0, pitch_deg=0, fov_deg=90, width_px=width_px,
                height_px=height_px)  # fmt: skip
    columns = np.arange(width_px, dtype=np.float32)[None]
    return radius_squared(view, columns, np.arange(height_px, dtype=np.float32)[:, None])


def _weighted(
    picture: Picture,
    gain: NDArray[np.float64],
    factor: NDArray[np.float32],
    uneven: bool,
) -> NDArray[np.float32]:
    """(h, w, 4): even linear color times weight, and the weight."""
    if picture.dtype == np.float32:
        even = picture * (1 / gain).astype(np.float32)
        one = np.ones(picture.shape[:2], np.float32)
        return np.asarray(cv2.multiply(cv2.merge([*cv2.split(even), one]), factor), np.float32)
    linear = cv2.LUT(cv2.cvtColor(picture, cv2.COLOR_RGB2RGBA), _table(gain))
    result = np.asarray(cv2.multiply(linear, factor), np.float32)
    if uneven:
        red, green, blue = cv2.split(picture)
        highest = cv2.max(cv2.max(red, green), blue)
        # With their neighbors: between a clipped pixel and a darker one, a view that leaves out
        # the clipped one alone would read the darker one.
        clipped = cv2.dilate(highest, np.ones((3, 3), np.uint8)) >= CLIPPED_CODE
        if clipped.any():
            result[clipped] *= np.float32(_CLIPPED_WEIGHT)
    return result


def _table(gain: NDArray[np.float64]) -> NDArray[np.float32]:
    """Code value to even linear light, (1, 256, 4); 1 in the last channel."""
    curve = srgb_decode_u8(np.arange(256, dtype=np.uint8))
    table = np.ones((256, 4), np.float32)
    table[:, :3] = curve[:, None] / gain
    # What was clipped is at least white, whatever the view's gain.
    table[CLIPPED_CODE:, :3] = np.maximum(table[CLIPPED_CODE:, :3], curve[CLIPPED_CODE:, None])
    return table[None]


@lru_cache(maxsize=1)
def _encode_table() -> NDArray[np.uint8]:
    """The sRGB codes of 16-bit linear values: half a code at most is lost in the darkest."""
    return srgb_encode_u8(np.arange(65536, dtype=np.float32) / 65535)


def _encoded(color: NDArray[np.float32]) -> NDArray[np.uint8]:
    sixteen = np.empty(color.shape, np.uint16)
    np.multiply(np.clip(color, 0, 1), np.float32(65535), out=sixteen, casting="unsafe")
    return np.take(_encode_table(), sixteen)


def _covered(valid: NDArray[np.bool_]) -> float:
    edges = np.cos(np.linspace(0, np.pi, len(valid) + 1))
    return float((valid.mean(axis=1) * (edges[:-1] - edges[1:])).sum() / 2)


def _check(pictures: Sequence[Picture], views: Sequence[View], width_px: int) -> None:
    if not pictures or len(pictures) != len(views):
        raise UsageError(
            f"Each picture needs one view and there must be at least one: got {len(pictures)} "
            f"pictures and {len(views)} views."
        )
    if len(views) > _MOST_VIEWS:
        raise UsageError(f"At most {_MOST_VIEWS} views make a panorama, not {len(views)}.")
    if width_px < 16 or width_px % 2:
        raise UsageError(f"A panorama is even and at least 16 px wide, not {width_px}.")
    kinds = {picture.dtype for picture in pictures}
    if len(kinds) > 1 or kinds - {np.dtype(np.uint8), np.dtype(np.float32)}:
        raise UsageError(
            "Views are all uint8 (display-encoded) or all float32 (linear), not "
            f"{', '.join(sorted(map(str, kinds)))}."
        )
    for picture, view in zip(pictures, views, strict=True):
        if picture.ndim != 3 or picture.shape != (view.height_px, view.width_px, 3):
            raise ImageError(
                f"The view {view.name} is {picture.shape}, not "
                f"{(view.height_px, view.width_px, 3)} as its record says. Correct the record.",
                reason="wrong-size",
            )
        if picture.dtype == np.float32 and not (
            np.isfinite(picture).all() and float(picture.min()) >= 0
        ):
            raise ImageError(
                f"The view {view.name} has negative or infinite values. Repair it first.",
                reason="not-physical",
            )

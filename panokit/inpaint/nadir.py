"""Find a cap around the point below the camera: a logo, a mirror ball, a blurred car.

A cap ends at the same angle all the way round. The world does not do that: a curb, a shadow
or a tripod's leg crosses some directions and not others. So the picture is unrolled around
the point below the camera, and a ring of change is looked for that nearly every direction
agrees on: of color, or of sharpness. A tripod without a plate is no cap and is not found.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import REC709_LUMINANCE
from panokit.inpaint.unroll import ROW_DEG, unrolled

_SECTORS = 36
_SMALLEST_DEG, _LARGEST_FILLED_DEG, _LARGEST_DEG = 3.0, 40.0, 62.0
# By how much the color must change within a degree and a half: a share of how bright it is
# there, so that a dark cap shows at night, within bounds, as lengths in RGB of 0 to 255.
_COLOR_SHARE = 0.1
_SMALLEST_COLOR_STEP, _LARGEST_COLOR_STEP = 4.0, 10.0
_COLOR_WINDOW_DEG = 0.75
# A tripod's three legs leave the edge undecided in up to a quarter of the directions.
_COLOR_AGREEMENT = 0.7
# Sharpness in the cap over that above it, and what counts as sharp at all.
_SHARPNESS_RATIO = 0.3
_SHARP = 1.0
_SHARPNESS_WINDOW_DEG = 3.0
_SHARPNESS_AGREEMENT = 0.85
_MARGIN_DEG = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class NadirCap:
    """A cap around the point below the camera.

    Attributes:
        radius_deg: Its angular radius, with a little margin.
        cue: "color" for a sharp edge, "blur" for a loss of detail.
        confidence: The share of directions that agree on it.
    """

    radius_deg: float
    cue: str
    confidence: float

    @property
    def is_a_hole(self) -> bool:
        """Whether to fill it. Blur over half the ground is not a hole but how it was taken."""
        return self.radius_deg <= _LARGEST_FILLED_DEG


def find_nadir_cap(pixels: NDArray[np.uint8], down: NDArray[np.floating]) -> NadirCap | None:
    """The cap around `down`, or None where nothing is plainly one.

    Args:
        pixels: (H, W, 3) uint8, equirectangular.
        down: (3,), the direction below the camera.
    """
    rows = unrolled(pixels, down)
    sectors = rows.reshape(len(rows), _SECTORS, -1, 3)
    found = [
        _ring(_color_change(sectors), "color", _COLOR_AGREEMENT),
        _blur_ring(sectors),
    ]
    caps = [cap for cap in found if cap is not None]
    return max(caps, key=lambda cap: (cap.confidence, cap.cue == "color"), default=None)


def find_blurred_ground(pixels: NDArray[np.uint8], down: NDArray[np.floating]) -> NadirCap | None:
    """Ground that was blurred far beyond any cap, or None: how some providers hide their car.

    Args:
        pixels: (H, W, 3) uint8, equirectangular.
        down: (3,), the direction below the camera.
    """
    rows = unrolled(pixels, down)
    blur = _blur_ring(rows.reshape(len(rows), _SECTORS, -1, 3))
    return None if blur is None or blur.is_a_hole else blur


def _color_change(sectors: NDArray[np.float32]) -> NDArray[np.float64]:
    """Per row the share of sectors whose color changes sharply right there."""
    window = round(_COLOR_WINDOW_DEG / ROW_DEG)
    inside, outside = _window_means(sectors.mean(axis=2), window)
    step = np.linalg.norm(outside - inside, axis=-1)
    darker = np.minimum(np.linalg.norm(inside, axis=-1), np.linalg.norm(outside, axis=-1))
    least = np.clip(_COLOR_SHARE * darker, _SMALLEST_COLOR_STEP, _LARGEST_COLOR_STEP)
    # A change is at its sharpest where the cap ends, in every sector alike.
    peak = cv2.dilate(step, np.ones((2 * window + 1, 1)))
    return np.asarray(((step > least) & (step > 0.8 * peak)).mean(axis=1))


def _sharpness_loss(sectors: NDArray[np.float32]) -> NDArray[np.float64]:
    """Per row the share of sectors that are sharp outside it and stay blurred inside."""
    gray = sectors @ REC709_LUMINANCE.astype(np.float32)
    # Only along the angle: around the nadir the picture is stretched, and always soft.
    sharpness = np.zeros(gray.shape[:2])
    sharpness[1:-1] = np.abs(gray[:-2] - 2 * gray[1:-1] + gray[2:]).mean(axis=2)
    window = round(_SHARPNESS_WINDOW_DEG / ROW_DEG)
    inside, outside = _window_means(sharpness, window)
    so_far = np.cumsum(sharpness, axis=0) / np.arange(1, len(sharpness) + 1)[:, None]
    lost = (outside > _SHARP) & (inside < _SHARPNESS_RATIO * outside)
    return np.asarray((lost & (so_far < _SHARPNESS_RATIO * outside)).mean(axis=1))


def _blur_ring(sectors: NDArray[np.float32]) -> NadirCap | None:
    # The loss shows once the window holds little of what is sharp: a little inside the edge.
    shift_deg = _SHARPNESS_RATIO * _SHARPNESS_WINDOW_DEG
    return _ring(_sharpness_loss(sectors), "blur", _SHARPNESS_AGREEMENT, shift_deg=shift_deg)


def _window_means(
    rows: NDArray[np.floating], window: int
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """At each row the mean of the `window` rows before it, and of those from it on."""
    total = np.concatenate([np.zeros((1, *rows.shape[1:])), np.cumsum(rows, axis=0)])
    middle = np.arange(len(rows))
    before, after = np.maximum(middle - window, 0), np.minimum(middle + window, len(rows))
    trailing = (...,) + (None,) * (rows.ndim - 1)
    inside = (total[middle] - total[before]) / np.maximum(middle - before, 1)[trailing]
    outside = (total[after] - total[middle]) / (after - middle)[trailing]
    return inside, outside


def _ring(
    agreement: NDArray[np.float64], cue: str, least: float, shift_deg: float = 0.0
) -> NadirCap | None:
    """The outermost ring that enough directions agree on, as a cap; of a logo, the last ring."""
    first, last = round(_SMALLEST_DEG / ROW_DEG), round(_LARGEST_DEG / ROW_DEG)
    agreeing = np.flatnonzero(agreement[first:last] >= least) + first
    if not len(agreeing):
        return None
    edge = int(agreeing[-1])
    # Rows in an unbroken run up to the edge all mean the same ring.
    start = agreeing[np.flatnonzero(np.diff(agreeing, prepend=-9) > 1)[-1]]
    return NadirCap(
        radius_deg=float(edge * ROW_DEG + shift_deg + _MARGIN_DEG),
        cue=cue,
        confidence=float(agreement[start : edge + 1].max()),
    )

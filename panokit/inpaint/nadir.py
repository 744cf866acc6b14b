"""Find a cap around the point below the camera: a logo, a mirror ball, a blurred car.

A cap ends at the same angle all the way round. The world does not do that: a curb, a shadow
or a tripod's leg crosses some directions and not others. So the picture is unrolled around
the point below the camera, and a ring of change is looked for that nearly every direction
agrees on: of color, or of sharpness. Tripods are not caps and are not found.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import REC709_LUMINANCE
from panokit.sphere import sample

_REACH_DEG = 70.0
_ROW_DEG = 0.125
_COLUMNS = 1440
_SECTORS = 36
_SMALLEST_DEG, _LARGEST_FILLED_DEG, _LARGEST_DEG = 3.0, 40.0, 62.0
_LEAST_AGREEMENT = 0.85
# Gray levels by which the color must change within a degree and a half.
_COLOR_STEP = 10.0
_COLOR_WINDOW_DEG = 0.75
# Sharpness in the cap over that above it, and what counts as sharp at all.
_SHARPNESS_RATIO = 0.3
_SHARP = 1.0
_SHARPNESS_WINDOW_DEG = 3.0
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
    unrolled = _unrolled(pixels, down)
    sectors = unrolled.reshape(len(unrolled), _SECTORS, -1, 3)
    found = [
        _ring(_color_change(sectors), "color"),
        # The loss shows once the window holds little of what is sharp: a little inside the edge.
        _ring(_sharpness_loss(sectors), "blur", _SHARPNESS_RATIO * _SHARPNESS_WINDOW_DEG),
    ]
    caps = [cap for cap in found if cap is not None]
    return max(caps, key=lambda cap: (cap.confidence, cap.cue == "color"), default=None)


def _unrolled(pixels: NDArray[np.uint8], down: NDArray[np.floating]) -> NDArray[np.float32]:
    """The picture with the angle from `down` as rows and the azimuth around it as columns."""
    width = 4 * _COLUMNS
    if pixels.shape[1] > width:
        reduced = cv2.resize(pixels, (width, width // 2), interpolation=cv2.INTER_AREA)
        pixels = np.asarray(reduced, np.uint8)
    angle = np.deg2rad((np.arange(int(_REACH_DEG / _ROW_DEG)) + 0.5) * _ROW_DEG)[:, None, None]
    around = (np.arange(_COLUMNS) / _COLUMNS * 2 * np.pi)[None, :, None]
    axis = np.asarray(down, np.float64) / np.linalg.norm(down)
    side = np.cross(axis, (1.0, 0, 0) if abs(axis[0]) < 0.9 else (0, 0, 1.0))
    side /= np.linalg.norm(side)
    across = np.cross(axis, side)
    directions = np.cos(angle) * axis + np.sin(angle) * (
        np.cos(around) * side + np.sin(around) * across
    )
    return np.asarray(sample(pixels, directions.astype(np.float32)), np.float32)


def _color_change(sectors: NDArray[np.float32]) -> NDArray[np.float64]:
    """Per row the share of sectors whose color changes sharply right there."""
    window = round(_COLOR_WINDOW_DEG / _ROW_DEG)
    inside, outside = _window_means(sectors.mean(axis=2), window)
    step = np.linalg.norm(outside - inside, axis=-1)
    # A change is at its sharpest where the cap ends, in every sector alike.
    peak = cv2.dilate(step, np.ones((2 * window + 1, 1)))
    return np.asarray(((step > _COLOR_STEP) & (step > 0.8 * peak)).mean(axis=1))


def _sharpness_loss(sectors: NDArray[np.float32]) -> NDArray[np.float64]:
    """Per row the share of sectors that are sharp outside it and stay blurred inside."""
    gray = sectors @ REC709_LUMINANCE.astype(np.float32)
    # Only along the angle: around the nadir the picture is stretched, and always soft.
    sharpness = np.zeros(gray.shape[:2])
    sharpness[1:-1] = np.abs(gray[:-2] - 2 * gray[1:-1] + gray[2:]).mean(axis=2)
    window = round(_SHARPNESS_WINDOW_DEG / _ROW_DEG)
    inside, outside = _window_means(sharpness, window)
    so_far = np.cumsum(sharpness, axis=0) / np.arange(1, len(sharpness) + 1)[:, None]
    lost = (outside > _SHARP) & (inside < _SHARPNESS_RATIO * outside)
    return np.asarray((lost & (so_far < _SHARPNESS_RATIO * outside)).mean(axis=1))


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


def _ring(agreement: NDArray[np.float64], cue: str, shift_deg: float = 0.0) -> NadirCap | None:
    """The outermost ring that enough directions agree on, as a cap; of a logo, the last ring."""
    first, last = round(_SMALLEST_DEG / _ROW_DEG), round(_LARGEST_DEG / _ROW_DEG)
    agreeing = np.flatnonzero(agreement[first:last] >= _LEAST_AGREEMENT) + first
    if not len(agreeing):
        return None
    edge = int(agreeing[-1])
    # Rows in an unbroken run up to the edge all mean the same ring.
    start = agreeing[np.flatnonzero(np.diff(agreeing, prepend=-9) > 1)[-1]]
    return NadirCap(
        radius_deg=float(edge * _ROW_DEG + shift_deg + _MARGIN_DEG),
        cue=cue,
        confidence=float(agreement[start : edge + 1].max()),
    )

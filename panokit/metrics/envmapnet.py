"""The light extraction of EnvMapNet as published, defects included.

Follows the reference code (apple/ml-envmapnet, ParametricLights.py) step by step, in the form
that DiffusionLight-evaluation made run on current NumPy, so that its printed scores can be
compared. What one would not expect of it:

- The loop over channels assigns where it should add, so "luminance" is 0.0722 B alone: a red
  lamp is not a light, and a blue sky is a strong one.
- The map is cut at the seam: a light across it is two lights. If its halves are equally bright,
  they carry one number, and as one region they are so wide that they are dropped as a band; two
  equal lamps far apart go the same way.
- Brightness is multiplied by sin(theta) before peaks are looked for, so a lamp at the zenith
  is as dark as night.
- Lights are numbered in scan order, from the top left, not by brightness, and it is the first
  five that are compared.
- The dilation with a 2x2 square grows regions to the upper left; the "+ 1" in the formulas of
  azimuth and elevation then happens to take the center back to where it was.
- The "size" of a light is arccos(major / minor axis), which is not a number unless they are
  equal. It is not computed here; no error depends on it.

`panokit.metrics.light_blobs` is the same method put right.
"""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.metrics.pairs import Radiance, check_radiance

_BLUE_WEIGHT = 0.0722
_REGION_OVER_PEAK = 0.3
_ENERGY_LEFT = 0.2
_PIXELS_LEFT = 0.1
_MOST_PEAKS = 15
_LARGEST_AREA = 0.5
_LONGEST_AXIS = 0.9


def envmapnet_lights(radiance: Radiance) -> NDArray[np.float64]:
    """The directions of the lights that the published code finds, in its order, (n, 3) float64.

    They are in the code's own axes (Z up, X at the right edge of the picture), which turn and
    mirror panokit's: angles between them are right, directions are not comparable.

    Args:
        radiance: (H, W, 3), linear, at the size to be judged at; nothing is resized.
    """
    check_radiance(np.asarray(radiance))
    height, width = radiance.shape[:2]
    regions = _regions(np.asarray(radiance))
    directions = []
    for number in range(1, int(regions.max()) + 1):
        outline = (regions == number).astype(np.uint8)
        contours, _ = cv2.findContours(outline, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        for contour in contours:
            x, y = _center(contour, width, height)
            polar = (y + 1.0) * 1.0 / height * np.pi
            azimuth = (1.0 - (x + 1.0) * 1.0 / (2.0 * height)) * 2.0 * np.pi
            directions.append(
                [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)]
            )
    return np.asarray(directions, np.float64).reshape(-1, 3)


def _regions(radiance: NDArray[np.floating[Any]]) -> NDArray[np.int32]:
    """Numbered light regions, (H, W), 0 outside."""
    height, width = radiance.shape[:2]
    weighted = _weighted_brightness(radiance)
    free = np.ones_like(weighted)
    peaks = np.zeros(weighted.shape, np.int32)
    total = np.sum(weighted)
    for number in range(1, _MOST_PEAKS + 1):
        rest = weighted * free
        seed = rest.max()
        regions = _numbered(rest >= seed * _REGION_OVER_PEAK)
        for label in np.unique(regions[rest >= seed]):
            if label:
                peaks[regions == label] = number
                free[regions == label] = 0
        if free.sum() < height * width * _PIXELS_LEFT:
            break
        if np.sum(free * weighted) < _ENERGY_LEFT * total:
            break
    for number in np.unique(peaks[peaks > 0]):
        region = peaks == number
        too_large = region.sum() / (height * width) > _LARGEST_AREA
        if too_large or _major_axis_px(region) / width > _LONGEST_AXIS:
            peaks[region] = 0
    return _numbered(_grown_up_left(peaks > 0))


def _weighted_brightness(radiance: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    height, width = radiance.shape[:2]
    size = int(height * 0.01 / 2) * 2 + 1
    blue = np.ascontiguousarray(radiance[..., 2] * _BLUE_WEIGHT)
    blurred = cv2.GaussianBlur(blue, (size, size), 0)
    offset = np.pi / (2 * height)
    sines = np.sin(np.linspace(offset, np.pi - offset, height))
    return np.asarray(blurred * np.tile(sines, (width, 1)).T, np.float64)


def _numbered(mask: NDArray[np.bool_]) -> NDArray[np.int32]:
    """8-connected regions, numbered as a scan from the top left meets them."""
    _, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    names, first = np.unique(labels[mask], return_index=True)
    numbers = np.zeros(int(labels.max()) + 1, np.int32)
    numbers[names[np.argsort(first)]] = np.arange(1, len(names) + 1)
    return np.asarray(numbers[labels], np.int32)


def _major_axis_px(region: NDArray[np.bool_]) -> float:
    """The length of the ellipse with the region's second moments: 4 sqrt(largest eigenvalue)."""
    points = np.argwhere(region).astype(np.float64)
    moments = np.cov(points, rowvar=False, bias=True) if len(points) > 1 else np.zeros((2, 2))
    return float(4 * np.sqrt(max(float(np.linalg.eigvalsh(moments)[-1]), 0.0)))


def _grown_up_left(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Dilation by a 2x2 square: a pixel is set if it, the next or the one below is."""
    padded = np.pad(mask, ((0, 1), (0, 1)), mode="edge")
    return padded[:-1, :-1] | padded[1:, :-1] | padded[:-1, 1:] | padded[1:, 1:]


def _center(contour: NDArray[np.int32], width: int, height: int) -> tuple[float, float]:
    if len(contour) <= 5:
        x, y = contour.mean(axis=0)[0]
        return float(x), float(y)
    (x, y), _, _ = cv2.fitEllipse(contour)
    if x < 0 or y < 0 or x > width or y > height:
        (x, y), _ = cv2.minEnclosingCircle(contour)
    return float(x), float(y)

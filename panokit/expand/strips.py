"""Maps wider than the networks look at: the same light, composed strip by strip.

What is decided of a panorama as a whole (the networks' answers, the burnt-out components and
their energies) is decided once, on a map of at most `WIDEST_WHOLE_PX`. What is left belongs to
single pixels, so strips of rows have no seams, and memory does not grow with the picture.
"""

from collections.abc import Callable, Iterator

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.expand.components import Components
from panokit.expand.network import Prediction, shown_light
from panokit.expand.reduce import ReducedPanorama, reduce_rows
from panokit.expand.spread import excess_scale, interpolate_gain, toward_middle
from panokit.sphere import row_solid_angles

# Panoramas up to here are worked on in one piece.
WIDEST_WHOLE_PX = 2048

_STRIP_PIXELS = 1 << 20


def compose_wide(
    pixels: NDArray[np.uint8], width_px: int, reduced: ReducedPanorama, prediction: Prediction
) -> NDArray[np.float32]:
    """What `compose` returns, at a greater width: radiance (width_px / 2, width_px, 3).

    Args:
        pixels: The panorama, (H, W, 3) uint8, W >= width_px.
        width_px: Of the result, at least that of `reduced`.
        reduced: The panorama as the networks saw it.
        prediction: What they said.
    """
    components = prediction.components
    count = len(components) + 1
    shown, drawn = np.zeros(count), np.zeros(count)
    radiance = np.empty((width_px // 2, width_px, 3), np.float32)
    area = row_solid_angles(width_px // 2, width_px)
    middle = toward_middle(
        components,
        np.concatenate([[0.0], components.energy]),
        prediction.energy,
        prediction.sun,
    )
    middle = _to_the_edge(middle, components.labels > 0)
    for rows, strip in _strips(pixels, width_px):
        gain = interpolate_gain(prediction.log_gain, reduced, width_px, rows)
        labels = _labels(components, width_px, rows)
        weight = np.where(labels > 0, _enlarged(middle, width_px, rows), 1)
        excess = strip.burnt * (gain - 1) * weight[..., None].astype(np.float32)
        radiance[rows] = excess
        shown += _sum_by_label(luminance(strip.burnt), labels, area[rows], count)
        drawn += _sum_by_label(luminance(excess), labels, area[rows], count)
    scale = excess_scale(prediction.energy, shown, drawn)
    for rows, strip in _strips(pixels, width_px):
        labels = _labels(components, width_px, rows)
        radiance[rows] *= scale[labels][..., None]
        radiance[rows] += shown_light(strip, prediction.curve_slopes)
    return radiance


def formula_wide(
    pixels: NDArray[np.uint8],
    width_px: int,
    formula: Callable[[ReducedPanorama], NDArray[np.float32]],
) -> NDArray[np.float32]:
    """What a formula that treats every pixel alike makes of a panorama; see `compose_wide`."""
    radiance = np.empty((width_px // 2, width_px, 3), np.float32)
    for rows, strip in _strips(pixels, width_px):
        radiance[rows] = formula(strip)
    return radiance


def multiply_wide(
    pixels: NDArray[np.uint8],
    width_px: int,
    components: Components,
    gains: NDArray[np.float64],
) -> NDArray[np.float32]:
    """The decoded picture with each component multiplied by its gain, (K,); see `compose_wide`."""
    radiance = np.empty((width_px // 2, width_px, 3), np.float32)
    by_label = np.concatenate([[1.0], gains]).astype(np.float32)
    for rows, strip in _strips(pixels, width_px):
        own = by_label[_labels(components, width_px, rows)]
        radiance[rows] = strip.clear + strip.burnt * own[..., None]
    return radiance


def _strips(pixels: NDArray[np.uint8], width_px: int) -> Iterator[tuple[slice, ReducedPanorama]]:
    height = width_px // 2
    step = max(_STRIP_PIXELS // width_px, 1)
    for first in range(0, height, step):
        last = min(first + step, height)
        yield slice(first, last), reduce_rows(pixels, width_px, first, last)


def _labels(components: Components, width_px: int, rows: slice) -> NDArray[np.int32]:
    """Which component each pixel of some rows belongs to."""
    height, width = components.labels.shape
    row = np.arange(rows.start, rows.stop) * height // (width_px // 2)
    column = np.arange(width_px) * width // width_px
    return components.labels[row[:, None], column[None, :]]


def _to_the_edge(weights: NDArray[np.float32], inside: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Weights that just outside of a component are those just inside: a finer picture's edge
    lies between the two, and must not take a share of what is outside.
    """  # noqa: D205
    far = np.where(inside, weights, np.float32(np.inf))
    padded = np.concatenate([far[:, -1:], far, far[:, :1]], axis=1)
    near = cv2.erode(padded, np.ones((3, 3), np.uint8))[:, 1:-1]
    return np.where(inside | np.isinf(near), weights, near).astype(np.float32)


def _enlarged(values: NDArray[np.float32], width_px: int, rows: slice) -> NDArray[np.float32]:
    """Some rows of a map (H, W) at a greater width, linear between the pixels' centers."""
    height, width = values.shape
    scale = width / width_px
    row = (np.arange(rows.start, rows.stop) + 0.5) * scale - 0.5
    first = int(np.clip(np.floor(row[0]), 0, height - 1))
    last = int(np.clip(np.ceil(row[-1]), 0, height - 1)) + 1
    part = values[first:last]

    wrapped = np.concatenate([part[:, -1:], part, part[:, :1]], axis=1)
    column = (np.arange(width_px) + 0.5) * scale + 0.5
    shape = (len(row), width_px)
    enlarged = cv2.remap(
        np.ascontiguousarray(wrapped),
        np.broadcast_to(column.astype(np.float32)[None, :], shape).copy(),
        np.broadcast_to((row - first).astype(np.float32)[:, None], shape).copy(),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return np.asarray(enlarged, np.float32)


def _sum_by_label(
    light: NDArray[np.floating],
    labels: NDArray[np.int32],
    area: NDArray[np.float64],
    count: int,
) -> NDArray[np.float64]:
    sums = np.bincount(labels.ravel(), (light * area[:, None]).ravel(), count)
    return np.asarray(sums, np.float64)

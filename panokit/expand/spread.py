"""From log gains on the coarse grid and energies of components to burnt-out light per pixel."""

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.expand.components import Components
from panokit.expand.features import GRID_HEIGHT_PX, GRID_WIDTH_PX
from panokit.expand.reduce import ReducedPanorama
from panokit.sphere import row_solid_angles

# Up to this half-width a component's light is drawn toward its middle, as a lamp's or a
# sun's is behind its glare; wider ones (skies, windows) are shaped by the grid alone.
COMPACT_DEG = 8.0
# Panels and windows are evenly lit and few times brighter than white; what is far brighter is a
# small source, and most of its burnt-out blob is glare.
GLARE_GAIN = 8.0
# The light falls with at most this power of the distance from the component's edge; a power
# of 4 puts half a sun's light within the middle quarter of its glare.
STEEPEST = 4.0
# From these odds on, a strong component is taken for the sun and its light drawn to the middle
# however wide its glare is; up to the first of them only its width counts.
SUN_FROM, SUN_SURE = 0.5, 0.8


def grid_energies(
    log_gain: NDArray[np.float32], reduced: ReducedPanorama, components: Components
) -> NDArray[np.float64]:
    """The luminance energy that the grid gives to each region.

    Args:
        log_gain: (3, 64, 128).
        reduced: The panorama.
        components: Those of `reduced`.

    Returns:
        (K + 1,) float64: first the burnt-out light outside the components, then each one's.
    """
    height, width = reduced.share.shape
    rows = np.arange(height) * GRID_HEIGHT_PX // height
    columns = np.arange(width) * GRID_WIDTH_PX // width
    gain = np.exp(np.maximum(log_gain, 0))[:, rows[:, None], columns[None, :]]
    light = luminance(reduced.burnt * gain.transpose(1, 2, 0))
    return _sum_by_label(light, components)


def spread_gain(
    log_gain: NDArray[np.float32],
    reduced: ReducedPanorama,
    components: Components,
    energies: NDArray[np.float64],
    sun: NDArray[np.float32] | None = None,
) -> NDArray[np.float32]:
    """The light that the picture lost, (H, W, 3) float32, >= 0.

    The grid's gain, interpolated so that no cell shows, gives the shape and the color; each
    region is then scaled to its energy. It is zero wherever nothing is burnt out.

    Args:
        log_gain: (3, 64, 128), of burnt-out light.
        reduced: The panorama.
        components: Those of `reduced`.
        energies: (K + 1,), as `grid_energies` returns them: what each region should have.
        sun: (K,), probability that a component is the sun; none is if not given.
    """
    height, width = reduced.share.shape
    gain = interpolate_gain(log_gain, reduced, width, slice(0, height))
    shown = _sum_by_label(luminance(reduced.burnt), components)
    middle = toward_middle(components, shown, energies, sun)
    excess = reduced.burnt * (gain - 1) * middle[..., None]
    drawn = _sum_by_label(luminance(excess), components)
    scale = excess_scale(energies, shown, drawn)
    return excess * scale[components.labels][..., None]


def excess_scale(
    energies: NDArray[np.float64], shown: NDArray[np.float64], drawn: NDArray[np.float64]
) -> NDArray[np.float32]:
    """What brings the light that was drawn in each region to its energy, (K + 1,) float32.

    Args:
        energies: That each region should have.
        shown: That it has in the picture.
        drawn: That was added to it, of any scale.
    """
    wanted = np.maximum(energies - shown, 0)
    scale = np.divide(wanted, drawn, out=np.zeros_like(drawn), where=drawn > 1e-12)
    return scale.astype(np.float32)


def _sum_by_label(light: NDArray[np.floating], components: Components) -> NDArray[np.float64]:
    height, width = light.shape
    weighted = light * row_solid_angles(height, width)[:, None]
    sums = np.bincount(components.labels.ravel(), weighted.ravel(), len(components) + 1)
    return np.asarray(sums, np.float64)


def toward_middle(
    components: Components,
    shown: NDArray[np.float64],
    energies: NDArray[np.float64],
    sun: NDArray[np.float32] | None,
) -> NDArray[np.float32]:
    """Weights in (0, 1] that fall to the edge of compact components and of suns, 1 elsewhere.

    The brighter a component is beyond what its picture shows, the more of what the picture
    shows is glare, and the smaller the source within.

    Args:
        components: Of the panorama.
        shown: (K + 1,), the energy of each region in the picture.
        energies: (K + 1,), what it should have.
        sun: (K,), probability that a component is the sun; none is if not given.
    """
    times_brighter = np.maximum(energies - shown, 0) / np.maximum(shown, 1e-12)
    odds = np.zeros(len(components), np.float32) if sun is None else sun
    radius = np.zeros(len(components) + 1, np.float32)
    np.maximum.at(radius, components.labels.ravel(), components.edge_deg.ravel())
    compact = np.clip(2 - 2 * radius / COMPACT_DEG, 0, 1)
    sure = np.clip((odds - SUN_FROM) / (SUN_SURE - SUN_FROM), 0, 1)
    compact[1:] = np.maximum(compact[1:], sure)
    power = compact * np.clip(np.log((times_brighter + 1) / GLARE_GAIN), 0, STEEPEST)
    inside = components.labels > 0
    label = components.labels[inside]
    relative = components.edge_deg[inside] / np.maximum(radius[label], 1e-6)
    weights = np.ones(components.labels.shape, np.float32)
    weights[inside] = np.maximum(relative, 0.05) ** power[label]
    return weights


def interpolate_gain(
    log_gain: NDArray[np.float32], reduced: ReducedPanorama, width: int, rows: slice
) -> NDArray[np.float32]:
    """The grid's gain at the pixels of some rows of a map, at least 1, (h, W, 3) float32.

    The log is linear between the cells' centers.

    Args:
        log_gain: (3, 64, 128).
        reduced: The panorama that it is for, at any width.
        width: Of the map.
        rows: Of the map.
    """
    share = reduced.at_width(GRID_WIDTH_PX).share
    grid = _filled(np.ascontiguousarray(log_gain.transpose(1, 2, 0)), share)
    wrapped = np.concatenate([grid[:, -2:], grid, grid[:, :2]], axis=1)
    column = (np.arange(width, dtype=np.float32) + 0.5) * (GRID_WIDTH_PX / width) + 1.5
    row = (np.arange(rows.start, rows.stop, dtype=np.float32) + 0.5) * (2 * GRID_HEIGHT_PX / width)
    row = np.clip(row - 0.5, 0, GRID_HEIGHT_PX - 1)
    shape = (len(row), width)
    interpolated = cv2.remap(
        wrapped,
        np.broadcast_to(column[None, :], shape).copy(),
        np.broadcast_to(row[:, None], shape).copy().astype(np.float32),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return np.asarray(np.exp(np.maximum(interpolated, 0)), np.float32)


def _filled(grid: NDArray[np.float32], share: NDArray[np.float32]) -> NDArray[np.float32]:
    """Cells without burnt-out light, where the network's answer has no meaning, take the mean
    of their burnt-out neighbors, so that interpolation does not pull edges toward it.
    """  # noqa: D205
    weight = share[..., None].astype(np.float32)
    padded = np.concatenate([grid * weight, weight], axis=2)
    padded = np.concatenate([padded[:, -1:], padded, padded[:, :1]], axis=1)
    blurred = cv2.blur(padded, (3, 3), borderType=cv2.BORDER_REPLICATE)[:, 1:-1]
    mean = blurred[..., :3] / np.maximum(blurred[..., 3:], 1e-6)
    return np.where((weight <= 1e-4) & (blurred[..., 3:] > 1e-5), mean, grid).astype(np.float32)

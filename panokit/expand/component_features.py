"""What the component network sees: each burnt-out component described by a row of numbers.

Nothing here depends on which azimuth is the picture's center.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.expand.components import Components, sum_by_component
from panokit.expand.features import GRID_HEIGHT_PX, GRID_WIDTH_PX
from panokit.expand.reduce import ReducedPanorama
from panokit.sphere import equirect_directions, row_solid_angles

RINGS_DEG = (0.0, 4.0, 8.0, 16.0, 32.0, 64.0)
COMPONENT_FEATURES = 60

_INTERIOR_DEG = (0.6, 1.5, 4.0)
_PERCENTILES = (10, 25, 50, 75, 90)


def component_features(
    reduced: ReducedPanorama, components: Components, grid: NDArray[np.float32]
) -> NDArray[np.float32]:
    """The component network's input, (K, 60) float32.

    Args:
        reduced: The panorama.
        components: Those of `reduced`.
        grid: `grid_features(reduced)`.
    """
    if not len(components):
        return np.zeros((0, COMPONENT_FEATURES), np.float32)
    shape, centers = _shape(reduced, components)
    scene, base_energy = _scene(grid)
    size = np.stack(
        [
            np.log(components.energy / base_energy),
            np.full(len(components), np.log(components.solid_angle.sum())),
            np.full(len(components), np.log(len(components))),
        ],
        axis=1,
    )
    around = _surroundings(grid, reduced, components, centers)
    repeated = np.broadcast_to(scene, (len(components), len(scene)))
    return np.concatenate([shape, size, around, repeated], axis=1).astype(np.float32)


def _shape(
    reduced: ReducedPanorama, components: Components
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    height, width = reduced.share.shape
    weights = row_solid_angles(height, width)[:, None] * reduced.share
    area = components.solid_angle
    directions = equirect_directions(width, height)
    picked = components.labels > 0
    owner, weight, direction = components.labels[picked] - 1, weights[picked], directions[picked]
    first = np.stack(
        [np.bincount(owner, weight * direction[:, i], len(area)) for i in range(3)], axis=1
    )
    centers = first / np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-12)
    spread = _spread(owner, weight, direction, centers)
    inradius = np.zeros(len(area))
    np.maximum.at(inradius, owner, components.edge_deg[picked])
    highest = np.full(len(area), -1.0)
    np.maximum.at(highest, owner, direction[:, 1])
    interior = [
        sum_by_component(weights * (components.edge_deg > limit), components) / area
        for limit in _INTERIOR_DEG
    ]
    white = sum_by_component(row_solid_angles(height, width)[:, None] * reduced.white, components)
    rank = np.arange(len(area))
    columns = [
        np.log(area),
        area / area.sum(),
        np.log(area / area[0]),
        1 / (1 + rank),
        (rank == 0).astype(float),
        *interior,
        np.log(np.maximum(inradius, 0.1)),
        np.log(area / np.radians(np.maximum(inradius, 0.1)) ** 2),
        spread[:, 0],
        spread[:, 1],
        centers[:, 1],
        highest,
        white / area,
    ]
    return np.stack(columns, axis=1), centers


def _spread(
    owner: NDArray[np.int32],
    weight: NDArray[np.floating],
    direction: NDArray[np.float32],
    centers: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Log of the larger and of the ratio of the two principal widths of each component."""
    offset = direction - centers[owner]
    count = len(centers)
    total = np.bincount(owner, weight, count)
    moments = np.empty((count, 3, 3))
    for i in range(3):
        for j in range(3):
            product = weight * offset[:, i] * offset[:, j]
            moments[:, i, j] = np.bincount(owner, product, count) / total
    widths = np.linalg.eigvalsh(moments)[:, ::-1]
    larger, smaller = widths[:, 0] + 1e-7, widths[:, 1] + 1e-7
    return np.stack([np.log(larger) / 2, np.log(larger / smaller) / 2], axis=1)


def _scene(grid: NDArray[np.float32]) -> tuple[NDArray[np.float64], float]:
    """Figures of the whole picture, and the energy of its part that is not burnt out."""
    encoded, clear, share = grid[0:3].astype(np.float64), grid[3:6], grid[9].astype(np.float64)
    weights = np.broadcast_to(row_solid_angles(GRID_HEIGHT_PX, GRID_WIDTH_PX)[:, None], share.shape)
    light = luminance(encoded.transpose(1, 2, 0))
    clear_light = luminance(clear.transpose(1, 2, 0)).astype(np.float64)
    base_energy = float((weights * clear_light).sum()) + 1e-3
    bands = np.array_split(np.arange(GRID_HEIGHT_PX), [22, 32, 42])
    figures: list[float] = []
    for rows in bands:
        weight = weights[rows] / weights[rows].sum()
        level = float((weight * light[rows]).sum())
        red, green, blue = ((weight * encoded[i][rows]).sum() + 1e-3 for i in range(3))
        figures += [level, float(np.log(red / green)), float(np.log(blue / green))]
        figures += [float((weight * share[rows]).sum()), float((weight * grid[12][rows]).sum())]
    open_cells = share < 0.5
    values = np.log(clear_light + 1e-3)[open_cells]
    figures += list(np.percentile(values, _PERCENTILES) if values.size else np.zeros(5))
    figures.append(float(np.log(base_energy)))
    return np.array(figures), base_energy


def _surroundings(
    grid: NDArray[np.float32],
    reduced: ReducedPanorama,
    components: Components,
    centers: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Rings around each component, and the ground and horizon before and behind it."""
    directions = equirect_directions(GRID_WIDTH_PX, GRID_HEIGHT_PX).reshape(-1, 3)
    cell_area = np.repeat(row_solid_angles(GRID_HEIGHT_PX, GRID_WIDTH_PX), GRID_WIDTH_PX)
    open_area = cell_area * (1 - grid[9].ravel())
    light = luminance(grid[0:3].transpose(1, 2, 0)).ravel()
    warmth = np.log((grid[0].ravel() + 0.02) / (grid[2].ravel() + 0.02))
    cell_of = _grid_cells(reduced.width_px)
    rows = []
    for k, center in enumerate(centers):
        cells = np.unique(cell_of[components.labels == k + 1])
        rim = directions[_rim(cells)]
        nearest = np.degrees(np.arccos(np.clip((directions @ rim.T).max(1), -1, 1)))
        nearest[cells] = -1
        figures: list[float] = []
        for low, high in pairwise(RINGS_DEG):
            ring = open_area * ((nearest >= low) & (nearest < high))
            figures += [_mean(light, ring), _mean(warmth, ring)]
        side = directions[:, 0] * center[0] + directions[:, 2] * center[2]
        elevation = directions[:, 1]
        for band in (elevation < -0.34, np.abs(elevation) <= 0.34):
            figures += [
                _mean(light, open_area * (band & (side > 0))),
                _mean(light, open_area * (band & (side <= 0))),
            ]
        rows.append([*figures, figures[-4] - figures[-3], figures[-2] - figures[-1]])
    return np.array(rows)


def _rim(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Those of a component's grid cells with a neighbor outside: what all others are nearest to."""
    inside = np.zeros((GRID_HEIGHT_PX, GRID_WIDTH_PX), bool)
    inside.flat[cells] = True
    wide = np.pad(inside, ((1, 1), (0, 0)), mode="edge")
    around = wide[:-2] & wide[2:] & np.roll(inside, 1, axis=1) & np.roll(inside, -1, axis=1)
    return np.asarray(np.flatnonzero(inside & ~around) if (inside & ~around).any() else cells)


def _mean(values: NDArray[np.floating], weights: NDArray[np.floating]) -> float:
    total = float(weights.sum())
    return float(weights @ values) / total if total > 1e-6 else 0.0


def _grid_cells(width_px: int) -> NDArray[np.int64]:
    row = (np.arange(width_px // 2) * GRID_HEIGHT_PX) // (width_px // 2)
    column = (np.arange(width_px) * GRID_WIDTH_PX) // width_px
    return row[:, None] * GRID_WIDTH_PX + column[None, :]

"""The bear on the floor: direct light with its shadow, no light from surface to surface.

The visible share of every light from every surface is a table: for every row of a grid of
lights, the columns at which that share changes. A light behind a surface is hidden from it.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from panokit.metrics.transport.figure import Hits, see
from panokit.metrics.transport.grids import collected, row_parts
from panokit.metrics.transport.linear import Separable, Shadowed, Step
from panokit.metrics.transport.tables import plane_table

Array = NDArray[np.float64]

# A map's texels are areas, not points: coarse ones are cut until they are this fine.
_FINEST_WIDTH_PX = 1024


def plane_steps(map_width_px: int) -> tuple[Step, ...]:
    """The chain of the plane scene: map, grid of lights above the floor, pixels."""
    table = plane_table()
    return lights(map_width_px, table.columns, table.rows), _surfaces()


def grid_directions(columns: int, rows: int) -> Array:
    """Nodes of an equirectangular grid above the floor, (columns, rows, 3) unit vectors."""
    azimuth = (((np.arange(columns) + 0.5) / columns - 0.5) * (2 * np.pi))[:, None]
    polar = (np.arange(rows) + 0.5) / rows * (np.pi / 2)
    x, z = np.sin(polar) * np.sin(azimuth), -np.sin(polar) * np.cos(azimuth)
    return np.stack([x, np.cos(polar) + 0 * azimuth, z], axis=-1)


def lights(map_width_px: int, columns: int, rows: int) -> Separable:
    """From a map's radiance to energy on the grid above the floor: (H, W, C) -> (w, h, C).

    Each texel's energy is shared linearly among four nodes. Light from below is dropped, since
    the floor hides it from everything in the picture.
    """
    height = map_width_px // 2
    parts = 2 * max(1, -(-_FINEST_WIDTH_PX // (2 * map_width_px)))
    texel, polar, share = row_parts(height, parts)
    above = polar < np.pi / 2
    place = polar[above] / (np.pi / 2) * rows - 0.5
    node, weights = _linear(place)
    node = np.clip(node, 0, rows - 1)
    down = collected(node, texel[above], weights * share[above, None], (rows, height))
    place = (np.arange(map_width_px * parts) + 0.5) / parts / map_width_px * columns - 0.5
    node, weights = _linear(place)
    texel = np.arange(map_width_px * parts) // parts
    along = collected(node % columns, texel, weights / parts, (columns, map_width_px))
    return Separable(rows=down, columns=along)


def _linear(place: Array) -> tuple[NDArray[np.intp], Array]:
    below = np.floor(place)
    far = place - below
    node = below.astype(np.intp)
    return np.stack([node, node + 1], axis=-1), np.stack([1 - far, far], axis=-1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Patches:
    """The parts of pixels that show one surface each: the floor or one sphere.

    Attributes:
        pixel: (N,) the pixel, row by row.
        normal: (N, 3) the sum over its rays of albedo x normal / pi, over the pixel's rays.
        rays: (N, R) whether each ray of the pixel belongs to it.
    """

    pixel: NDArray[np.intp]
    normal: Array
    rays: NDArray[np.bool_]


def patches(hits: Hits) -> Patches:
    """The picture in patches, pixel after pixel, for the baked table and its reading alike."""
    count = hits.sphere.shape[-1]
    sphere = hits.sphere.reshape(-1, count)
    scattered = (hits.albedo[..., None] / np.pi * hits.normal).reshape(-1, count, 3)
    surfaces = np.unique(sphere)
    belongs = sphere[:, None, :] == surfaces[:, None]
    pixel, surface = np.nonzero(belongs.any(axis=2))
    rays = belongs[pixel, surface]
    normal = np.einsum("nr,nrk->nk", rays / count, scattered[pixel])
    return Patches(pixel=pixel, normal=normal, rays=rays)


@lru_cache(maxsize=1)
def _surfaces() -> Shadowed:
    table = plane_table()
    seen = patches(see(table.size_px, table.rays))
    patch_and_row = np.repeat(np.arange(len(table.counts)), table.counts)
    patch, row = np.divmod(patch_and_row, table.rows)
    node = table.places * table.rows + row
    entries = seen.normal[patch] * (table.changes / table.unit)[:, None]
    # The floor's normal has one component only.
    used = entries != 0
    nodes = table.columns * table.rows
    column = (np.arange(3) * nodes + node[:, None])[used]
    pixels = table.size_px**2
    per_pixel = np.bincount(seen.pixel[patch], used.sum(axis=1), pixels).astype(np.intp)
    pointers = np.concatenate([[0], np.cumsum(per_pixel)])
    changes = csr_array(
        (entries[used].astype(np.float32), column.astype(np.int32), pointers),
        shape=(pixels, 3 * nodes),
    )
    changes.sum_duplicates()
    directions = grid_directions(table.columns, table.rows).astype(np.float32)
    shape = (table.size_px, table.size_px)
    return Shadowed(directions=directions, changes=changes, output_shape=shape)

"""The torch twin of `panokit.reflectance.sparse`: sparse reflectance maps for whole batches.

Equal to the numpy reference in colors and hits, for its rule "brightest", and fast enough to
run inside training. Pixels are ranked by luminance; each raises the rank of the cells within
its gate, one shift of the grid after the other.
"""

from functools import lru_cache

import numpy as np
import torch
from torch import Tensor

from panokit.color.luminance import REC709_LUMINANCE
from panokit.reflectance.grid import hemisphere_normals, reach_in_cells
from panokit.reflectance.sparse import GATE_DEG


def sparse_reflectance(
    pictures: Tensor,
    normals: Tensor,
    masks: Tensor,
    *,
    width_px: int = 64,
    gate_deg: float = GATE_DEG,
) -> tuple[Tensor, Tensor]:
    """Gather the colors of objects' pixels by their normals.

    Args:
        pictures: (B, 3, H, W).
        normals: (B, 3, H, W) in the camera's frame, of unit length where `masks` is true.
        masks: (B, H, W) bool.
        width_px: Of the maps.
        gate_deg: How far a pixel's normal may be from a cell's.

    Returns:
        Colors (B, 3, width, width), zero where a cell is empty, and hits (B, width, width)
        int64.
    """
    batch = pictures.shape[0]
    device = pictures.device
    table, number, margin, offsets = _tables(width_px, gate_deg)
    table, number = table.to(device), number.to(device)
    wide = width_px + 2 * margin
    cells = width_px * width_px
    sample, place = masks.flatten(1).nonzero(as_tuple=True)
    own = normals.flatten(2).permute(0, 2, 1)[sample, place].float()
    colors = pictures.flatten(2).permute(0, 2, 1)[sample, place]
    rank, by_rank = _ranks(colors)
    x, y, z = own.unbind(dim=1)
    column = ((x + 1) * (width_px / 2)).long().clamp_(0, width_px - 1)
    row = ((1 - y) * (width_px / 2)).long().clamp_(0, width_px - 1)
    first = sample * cells
    best = torch.full((batch * cells,), -1, dtype=torch.int64, device=device)
    hits = torch.zeros(batch * cells, dtype=torch.int64, device=device)
    least = float(np.float32(np.cos(np.deg2rad(gate_deg))))
    base = (row + margin) * wide + column + margin
    for down, right in offsets:
        there = base + (down * wide + right)
        n = table[there]
        cosine = x * n[:, 0] + y * n[:, 1] + z * n[:, 2]
        near = (cosine > least).nonzero().squeeze(1)
        cell = first[near] + number[there[near]]
        best.scatter_reduce_(0, cell, rank[near], reduce="amax")
        hits.scatter_add_(0, cell, torch.ones_like(cell))
    filled = best >= 0
    found = pictures.new_zeros((batch * cells, 3))
    found[filled] = colors[by_rank[best[filled]]]
    found = found.view(batch, width_px, width_px, 3).permute(0, 3, 1, 2)
    return found, hits.view(batch, width_px, width_px)


def _ranks(colors: Tensor) -> tuple[Tensor, Tensor]:
    """The rank of each pixel from dark to bright, of equal ones the first the highest.

    Returns:
        Rank of each pixel, and the pixel of each rank.
    """
    # In double precision, as the reference: rounding must not decide which pixel is brighter.
    weights = torch.tensor(REC709_LUMINANCE.tolist(), dtype=torch.float64, device=colors.device)
    light = colors.double() @ weights
    backward = torch.arange(len(light) - 1, -1, -1, device=light.device)
    by_rank = backward[light[backward].argsort(stable=True)]
    rank = torch.empty_like(by_rank)
    rank[by_rank] = torch.arange(len(light), device=light.device)
    return rank, by_rank


@lru_cache(maxsize=8)
def _tables(width_px: int, gate_deg: float) -> tuple[Tensor, Tensor, int, list[tuple[int, int]]]:
    """Normals and numbers of the cells of a grid with a margin, and the shifts within reach."""
    grid, inside = hemisphere_normals(width_px)
    offsets = reach_in_cells(gate_deg, width_px)
    margin = max(abs(row) for row, _ in offsets)
    wide = width_px + 2 * margin
    middle = slice(margin, margin + width_px)
    padded = np.zeros((wide, wide, 3), np.float32)
    padded[..., 2] = -2.0  # what no normal is near to
    padded[middle, middle][inside] = grid[inside]
    number = np.zeros((wide, wide), np.int64)
    number[middle, middle] = np.arange(width_px**2).reshape(width_px, width_px)
    return (
        torch.from_numpy(padded.reshape(-1, 3)), torch.from_numpy(number.reshape(-1)),
        margin, offsets,
    )  # fmt: skip

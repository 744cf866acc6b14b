"""The torch twin of `panokit.reflectance.sparse`: sparse reflectance maps for whole batches.

Equal to the numpy reference in colors and hits, for its rule "brightest", and fast enough to
run inside training. Which pixel a cell takes its color from has no gradient; its color has. On
processors the reference finds the pixels, several samples at a time. On graphics processors
pixels are ranked by luminance; each raises the rank of the cells within its gate, one shift of
the grid after the other.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from panokit.color.luminance import REC709_LUMINANCE
from panokit.reflectance.grid import hemisphere_normals, reach_in_cells
from panokit.reflectance.sparse import GATE_DEG, brightest_pixels


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
    pixel = masks.flatten().nonzero().squeeze(1)
    sample = pixel // (masks.shape[1] * masks.shape[2])
    # Pixel after pixel, whatever the batch's own order is: rows are taken faster than numbers.
    own, colors = (
        one.permute(0, 2, 3, 1).reshape(-1, 3).index_select(0, pixel)
        for one in (normals.float(), pictures)
    )
    find = _by_reference if pictures.device.type == "cpu" else _by_shifts
    best, hits = find(colors.detach(), own.detach(), sample, len(pictures), width_px, gate_deg)
    filled = best >= 0
    found = pictures.new_zeros((len(best), 3))
    found[filled] = colors[best[filled]]
    found = found.view(-1, width_px, width_px, 3).permute(0, 3, 1, 2)
    return found, hits.view(-1, width_px, width_px)


def _by_reference(
    colors: Tensor, own: Tensor, sample: Tensor, batch: int, width_px: int, gate_deg: float
) -> tuple[Tensor, Tensor]:
    """The pixel of each cell of each sample, or -1, and the hits; samples side by side."""
    counts = np.bincount(sample.numpy(), minlength=batch)
    first = np.concatenate([[0], np.cumsum(counts)])

    def find(number: int) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
        part = slice(first[number], first[number + 1])
        light = _luminance(colors[part]).numpy()
        best, hits = brightest_pixels(
            light, own[part].numpy(), width_px=width_px, gate_deg=gate_deg
        )
        return np.where(best >= 0, best + first[number], -1), hits

    with ThreadPoolExecutor(torch.get_num_threads()) as pool:
        found = list(pool.map(find, range(batch)))
    best, hits = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return torch.from_numpy(best), torch.from_numpy(hits).long()


def _by_shifts(
    colors: Tensor, own: Tensor, sample: Tensor, batch: int, width_px: int, gate_deg: float
) -> tuple[Tensor, Tensor]:
    """The same for all samples at once, on any device."""
    device = colors.device
    table, number, margin, offsets = _tables(width_px, gate_deg)
    table, number = table.to(device), number.to(device)
    wide = width_px + 2 * margin
    cells = width_px * width_px
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
    best[filled] = by_rank[best[filled]]
    return best, hits


def _ranks(colors: Tensor) -> tuple[Tensor, Tensor]:
    """The rank of each pixel from dark to bright, of equal ones the first the highest.

    Returns:
        Rank of each pixel, and the pixel of each rank.
    """
    light = _luminance(colors)
    backward = torch.arange(len(light) - 1, -1, -1, device=light.device)
    by_rank = backward[light[backward].argsort(stable=True)]
    rank = torch.empty_like(by_rank)
    rank[by_rank] = torch.arange(len(light), device=light.device)
    return rank, by_rank


def _luminance(colors: Tensor) -> Tensor:
    """In double precision, as the reference: rounding must not decide which pixel is brighter."""
    weights = torch.tensor(REC709_LUMINANCE.tolist(), dtype=torch.float64, device=colors.device)
    return colors.double() @ weights


@lru_cache(maxsize=8)
def _tables(width_px: int, gate_deg: float) -> tuple[Tensor, Tensor, int, list[tuple[int, int]]]:
    """Normals and numbers of the cells of a grid with a margin, and the shifts within reach."""
    grid, inside = hemisphere_normals(width_px)
    offsets = reach_in_cells(gate_deg, width_px)
    margin = max(abs(row) for row, _ in offsets)
    wide = width_px + 2 * margin
    middle = slice(margin, margin + width_px)
    padded = np.zeros((wide, wide, 3), np.float32)  # no normal is near to zero
    padded[middle, middle][inside] = grid[inside]
    number = np.zeros((wide, wide), np.int64)
    number[middle, middle] = np.arange(width_px**2).reshape(width_px, width_px)
    return (
        torch.from_numpy(padded.reshape(-1, 3)), torch.from_numpy(number.reshape(-1)),
        margin, offsets,
    )  # fmt: skip

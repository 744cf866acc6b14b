"""Which shifts of a picture would continue it into its hole: a few dozen out of all.

The ground repeats itself: paving has a period, a curb goes on along its own direction, gravel
fits nearly anywhere. Each stretch of the hole's edge is compared with the picture under every
shift at once (a cross-correlation by Fourier transform), and the shifts that fit it best are
kept. Few shifts make few, large, coherent pieces (He & Sun 2012, "Statistics of Patch Offsets
for Image Completion"); here they come from the edge of the hole rather than from everywhere.
"""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import fft

_SECTORS = 12
_PER_SECTOR = 3
_ALL_ROUND = 8
# Of the pixels of the band and of the hole behind it, what a shift must be able to serve.
_LEAST_BAND, _LEAST_HOLE = 0.6, 0.55
# A shift as long as the hole is wide may fit worse by this much, in gray levels.
_FAR = 3.0
_APART_PX = 2


def candidate_offsets(
    features: NDArray[np.float32],
    hole: NDArray[np.bool_],
    source: NDArray[np.bool_],
    band_px: int,
) -> list[tuple[int, int]]:
    """The shifts (rows, columns) worth trying, best first.

    Args:
        features: (H, W, C) float32, what should agree, in gray levels; ignored where unknown.
        hole: (H, W) bool, what is to be filled.
        source: (H, W) bool, what may be copied from.
        band_px: Width of the band around the hole that is compared.

    Returns:
        Without duplicates; empty if no shift can serve any part of the hole.
    """
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * band_px + 1,) * 2)
    band = (cv2.dilate(hole.astype(np.uint8), kernel) > 0) & source & ~hole
    search = _Search(features, source, float(np.sqrt(hole.sum())))
    found = search.best(band, hole, _ALL_ROUND)
    row, column = np.nonzero(hole)
    height, width = hole.shape
    y, x = np.mgrid[:height, :width]
    turn = np.arctan2(y - row.mean(), x - column.mean()) / (2 * np.pi) * _SECTORS
    for sector in range(_SECTORS):
        # A third of the way round each, so that neighbors overlap.
        away = np.abs((turn - sector + _SECTORS / 2) % _SECTORS - _SECTORS / 2)
        found += search.best(band & (away < 2), hole & (away < 1.5), _PER_SECTOR)
    found.sort()
    return _distinct([offset for _, offset in found])


class _Search:
    """Compares a picture with all its shifts at once."""

    def __init__(
        self, features: NDArray[np.float32], source: NDArray[np.bool_], hole_px: float
    ) -> None:
        height, width = source.shape
        self._features, self._hole_px = features, hole_px
        self._size = (fft.next_fast_len(2 * height, True), fft.next_fast_len(2 * width, True))
        known = source.astype(np.float32)
        shown = np.where(source[..., None], features, 0).astype(np.float32)
        self._known = self._forward(known)
        self._shown = [self._forward(channel) for channel in np.moveaxis(shown, -1, 0)]
        self._squares = self._forward((shown**2).sum(axis=-1))
        rows, columns = self._size
        self._down = (np.arange(rows) + rows // 2) % rows - rows // 2
        self._right = (np.arange(columns) + columns // 2) % columns - columns // 2
        length = np.hypot(self._down[:, None], self._right[None, :])
        self._far = (_FAR * length / max(hole_px, 1.0)).astype(np.float32)

    def best(
        self, band: NDArray[np.bool_], hole: NDArray[np.bool_], count: int
    ) -> list[tuple[float, tuple[int, int]]]:
        """The shifts under which the picture fits the band best and reaches into the hole."""
        if not band.any() or not hole.any():
            return []
        shown = np.where(band[..., None], self._features, 0).astype(np.float32)
        weight = self._forward(band.astype(np.float32))
        cross = sum(
            np.conj(self._forward(channel)) * other
            for channel, other in zip(np.moveaxis(shown, -1, 0), self._shown, strict=True)
        )
        squares = np.conj(self._forward((shown**2).sum(axis=-1))) * self._known
        total = squares - 2 * cross + np.conj(weight) * self._squares
        pairs = self._back(np.conj(weight) * self._known)
        serves = self._back(np.conj(self._forward(hole.astype(np.float32))) * self._known)
        usable = (pairs > _LEAST_BAND * band.sum()) & (serves > _LEAST_HOLE * hole.sum())
        mean = np.maximum(self._back(total), 0) / np.maximum(pairs, 1)
        score = np.where(usable, np.sqrt(mean) + self._far, np.inf).astype(np.float32)
        found = []
        for _ in range(count):
            place = np.unravel_index(int(np.argmin(score)), score.shape)
            if not np.isfinite(score[place]):
                break
            offset = (int(self._down[place[0]]), int(self._right[place[1]]))
            found.append((float(score[place]), offset))
            near = np.arange(-_APART_PX, _APART_PX + 1)
            rows, columns = self._size
            score[np.ix_((place[0] + near) % rows, (place[1] + near) % columns)] = np.inf
        return found

    def _forward(self, values: NDArray[np.float32]) -> NDArray[Any]:
        return np.asarray(fft.rfft2(values, self._size))

    def _back(self, spectrum: NDArray[Any]) -> NDArray[np.float32]:
        return np.asarray(fft.irfft2(spectrum, self._size), np.float32)


def _distinct(offsets: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """In order, without those next to an earlier one."""
    kept: list[tuple[int, int]] = []
    for offset in offsets:
        if all(max(abs(offset[0] - o[0]), abs(offset[1] - o[1])) > 1 for o in kept):
            kept.append(offset)
    return kept

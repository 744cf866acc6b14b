"""A big panorama averaged to a smaller one, row by row as it comes in.

A street panorama of 16384x8192 is 400 MB as bytes and 1.6 GB as floats. Handed over in
strips it needs neither: each strip is averaged and forgotten.
"""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_decode_u8, srgb_encode_u8

_STRIP_ROWS = 64
_ENCODE_ROWS = 256


class Reducer:
    """Averages the rows of a spherical picture to a smaller size.

    The mean is taken in linear light and over solid angle, so a small lamp keeps its share
    of the light. Pixels that are not valid take no part; a pixel of the result is valid if
    at least half of what it covers was.
    """

    def __init__(self, source_width_px: int, target_width_px: int) -> None:
        self._width, self._height = target_width_px, target_width_px // 2
        # A row's share of the sphere is the difference of the cosines at its edges.
        self._source_edges: NDArray[np.float64] = -np.cos(
            np.linspace(0, np.pi, source_width_px // 2 + 1)
        )
        self._target_edges = -np.cos(np.linspace(0, np.pi, self._height + 1))
        self._sums = np.zeros((self._height, self._width, 3), np.float32)
        self._coverage: NDArray[np.float32] | None = None

    def add(
        self, top: int, pixels: NDArray[np.uint8], valid: NDArray[np.bool_] | None = None
    ) -> None:
        """Take in some rows.

        Args:
            top: The first row's place in the big picture.
            pixels: (rows, W, 3) uint8, of the big picture's width.
            valid: (rows, W) bool; None if all are valid.
        """
        for start in range(0, len(pixels), _STRIP_ROWS):
            rows = slice(start, start + _STRIP_ROWS)
            linear = srgb_decode_u8(pixels[rows])
            if valid is not None:
                linear *= valid[rows, :, None]
            self._accumulate(self._sums, top + start, linear)
            if valid is not None:
                self._uncover(top + start, ~valid[rows])

    def result(self) -> tuple[NDArray[np.uint8], NDArray[np.bool_] | None]:
        """The smaller picture, (h, w, 3) uint8, and its valid mask, None if all is valid."""
        pixels = np.empty(self._sums.shape, np.uint8)
        for start in range(0, self._height, _ENCODE_ROWS):
            rows = slice(start, start + _ENCODE_ROWS)
            linear = self._sums[rows]
            if self._coverage is not None:
                covered = np.maximum(self._coverage[rows, :, None], 1e-3)
                linear = np.asarray(linear / covered, np.float32)
            pixels[rows] = srgb_encode_u8(linear)
        if self._coverage is None:
            return pixels, None
        valid = self._coverage >= 0.5
        pixels[~valid] = 0
        return pixels, valid

    def _uncover(self, top: int, missing: NDArray[np.bool_]) -> None:
        if self._coverage is None:
            self._coverage = np.ones((self._height, self._width), np.float32)
        self._accumulate(self._coverage, top, -missing.astype(np.float32))

    def _accumulate(self, sums: NDArray[Any], top: int, rows: NDArray[np.float32]) -> None:
        narrow = cv2.resize(rows, (self._width, len(rows)), interpolation=cv2.INTER_AREA)
        first, weights = self._row_weights(top, len(rows))
        flat = weights @ narrow.reshape(len(rows), -1)
        sums[first : first + len(weights)] += flat.reshape(len(weights), *sums.shape[1:])

    def _row_weights(self, top: int, count: int) -> tuple[int, NDArray[np.float32]]:
        """The first target row that the source rows touch, and their share of each from there.

        Returns:
            The row, and (target rows, `count`) float32.
        """
        source = self._source_edges[top : top + count + 1]
        scale = self._height / (len(self._source_edges) - 1)
        # One row more than needed on either side: what they do not share has weight 0.
        first = max(int(np.floor(top * scale)) - 1, 0)
        last = min(int(np.ceil((top + count) * scale)) + 1, self._height)
        target = self._target_edges[first : last + 1]
        shared = np.minimum(source[None, 1:], target[1:, None]) - np.maximum(
            source[None, :-1], target[:-1, None]
        )
        weights = np.maximum(shared, 0) / np.diff(target)[:, None]
        return first, weights.astype(np.float32)

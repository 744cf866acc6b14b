"""A mask made to fit the object: the colors in it against those around it.

Light on a glossy object has colors that no tolerance spans: highlights, shade, reflections. What
was filled tells enough of them to find the rest (GrabCut: Rother, Kolmogorov, Blake 2004).
"""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]
# The window around the object is worked on at this size.
_WORK_PX, _ITERATIONS = 200, 4
# The window's rim that surely is background, in parts of its size; and over how many pixels colors
# beside an outline are averaged.
_EDGE, _AROUND = 0.04, (9, 9)
_SEED = 20260101
# It has found its size when another round changes less than this.
_SETTLED = 1.1


def grown(
    picture: NDArray[np.uint8],
    mask: Mask,
    *,
    margin: float = 0.8,
    rounds: int = 4,
    work_px: int = _WORK_PX,
) -> Mask:
    """A mask that may be a part of an object, grown to the whole of it.

    Args:
        picture: (H, W, 3) uint8 RGB.
        mask: (H, W) bool, not empty: what surely belongs to it, but for its rim.
        margin: How far around it is looked, in parts of its size.
        rounds: At most.
        work_px: The longer side of the window around the mask, at which it is done.

    Returns:
        (H, W) bool; the mask itself where nothing is left of it.
    """
    area = float(mask.sum())
    for _ in range(rounds):
        found = _round(picture, mask, margin, work_px)
        now = float(found.sum())
        if now == 0:
            return mask
        mask = found
        if max(now / area, area / now) < _SETTLED:
            break
        area = now
    return mask


def fitted(picture: NDArray[np.uint8], mask: Mask, *, band: float = 0.05) -> Mask:
    """A mask from another frame, made to fit the object here.

    Args:
        picture: (H, W, 3) uint8 RGB.
        mask: (H, W) bool, not empty, where the object is but for a little.
        band: How far its outline may move, in parts of its size.
    """
    window = _Window.around(mask, 2 * band)
    part = window.of(picture)
    inner = window.of(mask).astype(np.uint8)
    reach = max(2, round(band * max(inner.shape)))
    disk = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    labels = np.where(inner > 0, cv2.GC_PR_FGD, cv2.GC_PR_BGD).astype(np.uint8)
    labels[cv2.erode(inner, disk) > 0] = cv2.GC_FGD
    labels[cv2.dilate(inner, disk) == 0] = cv2.GC_BGD
    return window.laid(_cut(part, labels), mask)


def outline_contrast(picture: NDArray[np.uint8], mask: Mask) -> float:
    """How much the colors on both sides of an outline differ along most of it, in CIE LAB.

    The quarter of the outline where they differ least decides: a mask that ends in the middle of
    an object has such a quarter, one that ends where the object does has none.
    """
    window = _Window.around(mask, 0.1)
    part, inner = window.of(picture), window.of(mask).astype(np.uint8)
    lab = cv2.cvtColor(part.astype(np.float32) / np.float32(255), cv2.COLOR_RGB2LAB)
    rim, near = np.ones((5, 5), np.uint8), np.ones((3, 3), np.uint8)
    inside = ((inner > 0) & (cv2.erode(inner, rim) == 0)).astype(np.float32)
    outside = ((inner == 0) & (cv2.dilate(inner, rim) > 0)).astype(np.float32)
    shares = [cv2.blur(side, _AROUND) for side in (inside, outside)]
    at = (cv2.dilate(inner, near) > 0) & (inner == 0) & (shares[0] > 1e-3) & (shares[1] > 1e-3)
    if not at.any():
        return 0.0
    means = [
        cv2.blur(lab * side[..., None], _AROUND)[at] / share[at][:, None]
        for side, share in zip((inside, outside), shares, strict=True)
    ]
    return float(np.percentile(np.linalg.norm(means[0] - means[1], axis=-1), 25))


@dataclass(frozen=True, slots=True)
class _Window:
    """A part of a picture."""

    rows: slice
    columns: slice

    @classmethod
    def around(cls, mask: Mask, margin: float) -> "_Window":
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        more = int(np.ceil(margin * max(np.ptp(rows), np.ptp(columns)))) + 3
        return cls(
            slice(max(0, int(rows[0]) - more), int(rows[-1]) + more + 1),
            slice(max(0, int(columns[0]) - more), int(columns[-1]) + more + 1),
        )

    def of(self, picture: NDArray[Any]) -> NDArray[Any]:
        return np.ascontiguousarray(picture[self.rows, self.columns])

    def laid(self, part: Mask, mask: Mask) -> Mask:
        """The part at its place, empty elsewhere: the piece that shares most with a mask."""
        whole = np.zeros_like(mask)
        whole[self.rows, self.columns] = part
        return _connected(whole, mask)


def _round(picture: NDArray[np.uint8], mask: Mask, margin: float, work_px: int) -> Mask:
    window = _Window.around(mask, margin)
    part = window.of(picture)
    scale = min(1.0, work_px / max(part.shape[:2]))
    size = (max(8, round(part.shape[1] * scale)), max(8, round(part.shape[0] * scale)))
    small = np.asarray(cv2.resize(part, size, interpolation=cv2.INTER_AREA), np.uint8)
    inner = window.of(mask).astype(np.uint8)
    sure = cv2.resize(inner, size, interpolation=cv2.INTER_NEAREST)
    labels = np.full(sure.shape, cv2.GC_PR_BGD, np.uint8)
    labels[sure > 0] = cv2.GC_PR_FGD
    labels[cv2.erode(sure, np.ones((3, 3), np.uint8)) > 0] = cv2.GC_FGD
    edge = max(1, round(_EDGE * max(size)))
    for side in (labels[:edge], labels[-edge:], labels[:, :edge], labels[:, -edge:]):
        side[side != cv2.GC_FGD] = cv2.GC_BGD
    share = _cut(small, labels).astype(np.float32)
    return window.laid(np.asarray(cv2.resize(share, part.shape[1::-1]) > 0.5), mask)


def _cut(picture: NDArray[np.uint8], labels: NDArray[np.uint8]) -> Mask:
    """GrabCut from what is sure and what is likely."""
    if (labels == cv2.GC_FGD).any() and (labels == cv2.GC_BGD).any():
        # Its clusters start at random; the same seed gives the same mask.
        cv2.setRNGSeed(_SEED)
        colors = cv2.cvtColor(picture, cv2.COLOR_RGB2LAB)
        models = (np.zeros((1, 65)), np.zeros((1, 65)))
        cv2.grabCut(colors, labels, (0, 0, 1, 1), *models, _ITERATIONS, cv2.GC_INIT_WITH_MASK)
    return np.asarray((labels == cv2.GC_FGD) | (labels == cv2.GC_PR_FGD))


def _connected(found: Mask, before: Mask) -> Mask:
    """The piece that shares most with the mask of before."""
    _, labels = cv2.connectedComponents(found.astype(np.uint8))
    shared = np.bincount(labels[before & found].ravel())
    return np.asarray(labels == int(shared.argmax())) if len(shared) else found

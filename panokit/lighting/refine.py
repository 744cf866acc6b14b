"""A mask made to fit the object: the colors in it against those around it.

Light on a glossy object has colors that no tolerance spans: highlights, shade, reflections. What
was filled tells enough of them to find the rest (GrabCut: Rother, Kolmogorov, Blake 2004).
"""

import cv2
import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]
_WORK_PX, _ITERATIONS = 200, 4
_EDGE = 0.04
_SEED = 20260101
# It has found its size when another round changes less than this.
_SETTLED = 1.1


def grown(picture: NDArray[np.uint8], mask: Mask, *, margin: float = 0.8, rounds: int = 4) -> Mask:
    """A mask that may be a part of an object, grown to the whole of it.

    Args:
        picture: (H, W, 3) uint8 RGB.
        mask: (H, W) bool, not empty: what surely belongs to it, but for its rim.
        margin: How far around it is looked, in parts of its size.
        rounds: At most.
    """
    area = float(mask.sum())
    for _ in range(rounds):
        found = _round(picture, mask, margin)
        now = float(found.sum())
        if now == 0:
            return mask
        mask = found
        if max(now / area, area / now) < _SETTLED:
            break
        area = now
    return mask


def _round(picture: NDArray[np.uint8], mask: Mask, margin: float) -> Mask:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    around = int(np.ceil(margin * max(np.ptp(rows), np.ptp(columns)))) + 3
    height, width = mask.shape
    left, top = max(0, columns[0] - around), max(0, rows[0] - around)
    right, bottom = min(width, columns[-1] + around + 1), min(height, rows[-1] + around + 1)
    part = np.ascontiguousarray(picture[top:bottom, left:right])
    inner = mask[top:bottom, left:right].astype(np.uint8)
    scale = min(1.0, _WORK_PX / max(part.shape[:2]))
    size = (max(8, round(part.shape[1] * scale)), max(8, round(part.shape[0] * scale)))
    small = cv2.resize(part, size, interpolation=cv2.INTER_AREA)
    sure = cv2.resize(inner, size, interpolation=cv2.INTER_NEAREST)
    labels = np.full(sure.shape, cv2.GC_PR_BGD, np.uint8)
    labels[sure > 0] = cv2.GC_PR_FGD
    labels[cv2.erode(sure, np.ones((3, 3), np.uint8)) > 0] = cv2.GC_FGD
    edge = max(1, round(_EDGE * max(size)))
    for side in (labels[:edge], labels[-edge:], labels[:, :edge], labels[:, -edge:]):
        side[side != cv2.GC_FGD] = cv2.GC_BGD
    if not (labels == cv2.GC_FGD).any() or not (labels == cv2.GC_BGD).any():
        return mask
    # Its clusters start at random; the same seed gives the same mask.
    cv2.setRNGSeed(_SEED)
    colors = cv2.cvtColor(np.asarray(small, np.uint8), cv2.COLOR_RGB2LAB)
    models = (np.zeros((1, 65)), np.zeros((1, 65)))
    cv2.grabCut(colors, labels, None, *models, _ITERATIONS, cv2.GC_INIT_WITH_MASK)
    is_object = (labels == cv2.GC_FGD) | (labels == cv2.GC_PR_FGD)
    share = cv2.resize(is_object.astype(np.float32), (part.shape[1], part.shape[0]))
    result = np.zeros_like(mask)
    result[top:bottom, left:right] = share > 0.5
    return _connected(result, mask)


def _connected(found: Mask, before: Mask) -> Mask:
    """The piece that shares most with the mask of before."""
    _, labels = cv2.connectedComponents(found.astype(np.uint8))
    shared = np.bincount(labels[before & found].ravel())
    return np.asarray(labels == int(shared.argmax())) if len(shared) else found

"""Pictures and normals at the size that a network takes, in training and in use."""

import cv2
import numpy as np
from numpy.typing import NDArray

# Shorter than this is a mean of unit normals where half of the pixels had none.
_LEAST_LENGTH = 0.5


def smaller_picture(picture: NDArray[np.uint8], size_px: int) -> NDArray[np.uint8]:
    """A square picture at another size: means over what becomes one pixel.

    Args:
        picture: (S, S, 3) uint8, display-encoded; averaged as it is.
        size_px: Width and height of the result.

    Returns:
        (size_px, size_px, 3) uint8; the picture itself where it has that size.
    """
    if picture.shape[:2] == (size_px, size_px):
        return picture
    size = (size_px, size_px)
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)


def smaller_normals(normals: NDArray[np.float32], size_px: int) -> NDArray[np.float32]:
    """Normals of larger pixels: means, made unit again.

    Args:
        normals: (S, S, 3) float32, of unit length or 0 where there is none.
        size_px: Width and height of the result.

    Returns:
        (size_px, size_px, 3) float32, see `unit_normals`; the normals themselves where they have
        that size.
    """
    if normals.shape[:2] == (size_px, size_px):
        return normals
    size = (size_px, size_px)
    means = np.asarray(cv2.resize(normals, size, interpolation=cv2.INTER_AREA), np.float32)
    return unit_normals(means)


def unit_normals(normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """(H, W, 3) float32 of unit length, 0 where less than half of a pixel has a normal."""
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    unit = np.where(length > _LEAST_LENGTH, normals / np.maximum(length, 1e-6), 0)
    return unit.astype(np.float32)

"""Pictures with a border, so that a filter near their edges reads what the sphere shows there."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.sphere.cubemap import FACES, Cubemap, face_coordinates, split_faces
from panokit.sphere.equirect import Equirectangular
from panokit.sphere.projection import Coordinates, Mask, Projection

# Faces in one atlas, so that one call samples all six; three wide keeps it under cv2's limit.
_ATLAS_WIDE = 3


def pad_sphere(picture: NDArray[Any], pad_px: int = 1) -> NDArray[Any]:
    """An equirectangular picture with `pad_px` more pixels on each side, as the sphere goes on.

    Columns wrap; above the zenith the picture goes on at the opposite azimuth, so rows are
    mirrored and rolled by half the width.

    Raises:
        UsageError: If the width is odd: then no column is opposite.
    """
    height, width = picture.shape[:2]
    if width % 2:
        raise UsageError(f"A spherical picture has an even width; this one has {width}.")
    if pad_px > min(height, width):
        raise UsageError(f"A {width}x{height} picture is too small for a border of {pad_px}.")
    padded = np.empty((height + 2 * pad_px, width + 2 * pad_px, *picture.shape[2:]), picture.dtype)
    inner = slice(pad_px, pad_px + width)
    padded[pad_px : pad_px + height, inner] = picture
    half = width // 2
    for target, source in (
        (slice(0, pad_px), picture[:pad_px][::-1]),
        (slice(pad_px + height, None), picture[height - pad_px :][::-1]),
    ):
        padded[target, pad_px : pad_px + half] = source[:, half:]
        padded[target, pad_px + half : pad_px + width] = source[:, :half]
    padded[:, :pad_px] = padded[:, width : width + pad_px]
    padded[:, pad_px + width :] = padded[:, pad_px : 2 * pad_px]
    return padded


def extend(picture: NDArray[Any], projection: Projection, pad_px: int) -> NDArray[Any]:
    """The picture with a border of `pad_px` and its gaps filled, as the sphere continues there.

    A cubemap becomes an atlas of its six faces, three wide, each with a border of its own.
    Beyond what the picture shows at all, its edge is repeated.
    """
    if isinstance(projection, Equirectangular):
        return pad_sphere(picture, pad_px)
    if isinstance(projection, Cubemap):
        return _atlas(picture, projection, pad_px)
    height, width = picture.shape[:2]
    column = np.arange(-pad_px, width + pad_px, dtype=np.float64)[None, :]
    row = np.arange(-pad_px, height + pad_px, dtype=np.float64)[:, None]
    directions, valid = projection.directions(column, row, width, height)
    # Only what lies beyond the edges needs a look at the sphere.
    beyond = ~valid | (column < 0) | (column > width - 1) | (row < 0) | (row > height - 1)
    extended = cv2.copyMakeBorder(
        np.ascontiguousarray(picture), pad_px, pad_px, pad_px, pad_px, cv2.BORDER_REPLICATE
    )
    found_column, found_row, _ = projection.pixel(directions[beyond], width, height)
    # The edge of a disc cuts through pixels; half a pixel further in all four are full.
    extended[beyond] = _read(picture, found_column, found_row)
    return extended


def locate(
    directions: Coordinates, projection: Projection, width_px: int, height_px: int, pad_px: int
) -> tuple[Coordinates, Coordinates, Mask]:
    """Where directions (..., 3) fall in what `extend` makes of a picture of this size."""
    if isinstance(projection, Cubemap):
        size = projection.face_size(width_px, height_px)
        face, x, y = face_coordinates(directions)
        cell = size + 2 * pad_px
        column = (x + 1) / 2 * size - 0.5 + pad_px + (face % _ATLAS_WIDE) * cell
        row = (1 - y) / 2 * size - 0.5 + pad_px + (face // _ATLAS_WIDE) * cell
        return column, row, np.ones(column.shape, bool)
    across, down, inside = projection.pixel(directions, width_px, height_px)
    return across + pad_px, down + pad_px, inside


def _atlas(picture: NDArray[Any], projection: Cubemap, pad_px: int) -> NDArray[Any]:
    faces = split_faces(picture, projection.layout)
    size = faces["front"].shape[0]
    cell = size + 2 * pad_px
    atlas = np.empty(
        (len(FACES) // _ATLAS_WIDE * cell, _ATLAS_WIDE * cell, *picture.shape[2:]), picture.dtype
    )
    x = (np.arange(-pad_px, size + pad_px) + 0.5) / size * 2 - 1
    across, upward = np.meshgrid(x, -x)
    border = (np.abs(across) > 1) | (np.abs(upward) > 1)
    local = np.stack([across[border], upward[border], np.full(int(border.sum()), -1.0)], axis=-1)
    names = list(FACES)
    for index, name in enumerate(names):
        top, left = index // _ATLAS_WIDE * cell, index % _ATLAS_WIDE * cell
        own = atlas[top : top + cell, left : left + cell]
        own[pad_px : pad_px + size, pad_px : pad_px + size] = faces[name]
        face, u, v = face_coordinates(FACES[name].apply(local))
        values = np.empty((len(face), *picture.shape[2:]), picture.dtype)
        for other in np.unique(face):
            met = face == other
            values[met] = _read(
                faces[names[other]],
                (u[met] + 1) / 2 * size - 0.5,
                (1 - v[met]) / 2 * size - 0.5,
            )
        own[border] = values
    return atlas


def _read(picture: NDArray[Any], column: Coordinates, row: Coordinates) -> NDArray[Any]:
    """Linear interpolation at a list of places, (n[, C]); beyond the edges they repeat."""
    # cv2.remap takes no picture of 32768 or more on a side, so the list becomes a block.
    count = len(column)
    wide = 1 << 12
    block = np.zeros((2, -(-count // wide) * wide), np.float32)
    block[0, :count], block[1, :count] = column, row
    read = cv2.remap(
        np.ascontiguousarray(picture),
        block[0].reshape(-1, wide),
        block[1].reshape(-1, wide),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return read.reshape(-1, *picture.shape[2:])[:count]

"""OpenEXR's cube maps: six faces in a column, pixel centers on the edges of the cube.

Faces from top to bottom: +X, -X, +Y, -Y, +Z, -Z, in OpenEXR's frame; how each lies follows
from ImfEnvmap.h. Neighbors share their border pixels, so interpolation never leaves a face.
"""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError
from panokit.frames import TOOL_FROM_PANOKIT
from panokit.sphere import equirect_directions, resize_radiance

# For each face: the axis it looks along with its sign, then the axes that its columns and
# rows follow, each with a sign.
_FACES = (
    ((0, 1), (2, 1), (1, -1)),
    ((0, -1), (2, -1), (1, -1)),
    ((1, 1), (0, 1), (2, -1)),
    ((1, -1), (0, 1), (2, 1)),
    ((2, 1), (0, -1), (1, -1)),
    ((2, -1), (0, 1), (1, -1)),
)
_SUPERSAMPLING = 2


def equirect_from_exr_cube(pixels: NDArray[np.float32], path: Path) -> NDArray[np.float32]:
    """The cube map (6 N, N, 3) as an equirectangular map (2 N, 4 N, 3).

    Raises:
        ImageError: If its height is not six times its width.
    """
    size = pixels.shape[1]
    if pixels.shape[0] != 6 * size or size < 4:
        raise ImageError(
            f"{path} says it is a cube map but is {size}x{pixels.shape[0]}, not six squares "
            "in a column. Convert it with OpenEXR's exrenvmap.",
            reason="wrong-size",
        )
    width = 4 * size * _SUPERSAMPLING
    directions = TOOL_FROM_PANOKIT["openexr"].apply(equirect_directions(width, width // 2))
    result = np.empty((*directions.shape[:2], 3), np.float32)
    longest = np.abs(directions).argmax(axis=-1)
    for face, ((axis, sign), column_axis, row_axis) in enumerate(_FACES):
        chosen = (longest == axis) & (directions[..., axis] * sign > 0)
        toward = directions[chosen]
        depth = np.abs(toward[:, axis])
        column, row = (
            ((toward[:, one] * direction / depth + 1) / 2 * (size - 1)).astype(np.float32)
            for one, direction in (column_axis, row_axis)
        )
        result[chosen] = _interpolate(pixels[face * size : (face + 1) * size], column, row)
    return resize_radiance(result, 4 * size)


def _interpolate(
    face: NDArray[np.float32], column: NDArray[np.float32], row: NDArray[np.float32]
) -> NDArray[np.float32]:
    # cv2.remap takes no more than 32767 rows, so the list is folded into a picture.
    count = len(column)
    side = int(np.ceil(np.sqrt(count)))
    picture = cv2.remap(
        np.ascontiguousarray(face),
        np.resize(column, (side, side)),
        np.resize(row, (side, side)),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return np.asarray(picture.reshape(-1, 3)[:count], np.float32)

"""The sphere as six square faces, each seen from inside."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.frames import Rotation
from panokit.sphere.perspective import perspective_directions
from panokit.sphere.sampling import sample

# How a camera that looks along -Z with +Y up is turned to look at each face.
FACES: dict[str, Rotation] = {
    "right": Rotation.about_axis((0, 1, 0), -np.pi / 2),
    "left": Rotation.about_axis((0, 1, 0), np.pi / 2),
    "up": Rotation.about_axis((1, 0, 0), np.pi / 2),
    "down": Rotation.about_axis((1, 0, 0), -np.pi / 2),
    "front": Rotation.identity(),
    "back": Rotation.about_axis((0, 1, 0), np.pi),
}


def cubemap_directions(size_px: int, face: str) -> NDArray[np.float32]:
    """The unit direction behind each pixel of a face, (size_px, size_px, 3) float32."""
    return perspective_directions(size_px, size_px, 90.0, FACES[face])


def cubemap_faces(picture: NDArray[Any], size_px: int) -> dict[str, NDArray[Any]]:
    """The six faces of an equirectangular picture, each (size_px, size_px[, C]).

    The faces share edges, not pixels: a face is exactly 90 degrees wide between the outer
    edges of its outer pixels.
    """
    return {face: sample(picture, cubemap_directions(size_px, face)) for face in FACES}

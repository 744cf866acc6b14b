"""The sphere as six square faces, each seen from inside, in the layouts that tools use.

    horizontal-cross           vertical-cross      row: right left up down front back
          up                         up            column: the same, stacked
    left  front right back      left front right   grid: right left up / down front back
          down                       down
                                     back (upside down)

A face is exactly 90 degrees wide between the outer edges of its outer pixels: faces share
edges, not pixels.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.sphere.perspective import perspective_directions
from panokit.sphere.projection import Coordinates, Mask

# How a camera that looks along -Z with +Y up is turned to look at each face.
FACES: dict[str, Rotation] = {
    "right": Rotation.about_axis((0, 1, 0), -np.pi / 2),
    "left": Rotation.about_axis((0, 1, 0), np.pi / 2),
    "up": Rotation.about_axis((1, 0, 0), np.pi / 2),
    "down": Rotation.about_axis((1, 0, 0), -np.pi / 2),
    "front": Rotation.identity(),
    "back": Rotation.about_axis((0, 1, 0), np.pi),
}
_ORDER = tuple(FACES)

# Layout -> face -> (column of cells, row of cells, turned by half a turn).
LAYOUTS: dict[str, dict[str, tuple[int, int, bool]]] = {
    "horizontal-cross": {
        "up": (1, 0, False), "left": (0, 1, False), "front": (1, 1, False),
        "right": (2, 1, False), "back": (3, 1, False), "down": (1, 2, False),
    },
    "vertical-cross": {
        "up": (1, 0, False), "left": (0, 1, False), "front": (1, 1, False),
        "right": (2, 1, False), "down": (1, 2, False), "back": (1, 3, True),
    },
    "row": {face: (index, 0, False) for index, face in enumerate(_ORDER)},
    "column": {face: (0, index, False) for index, face in enumerate(_ORDER)},
    "grid": {face: (index % 3, index // 3, False) for index, face in enumerate(_ORDER)},
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Cubemap:
    """Six faces in one picture.

    Attributes:
        layout: One of `LAYOUTS`.
    """

    layout: str = "horizontal-cross"

    def __post_init__(self) -> None:
        if self.layout not in LAYOUTS:
            known = ", ".join(LAYOUTS)
            raise UsageError(f"No cubemap layout {self.layout!r}; there are {known}.")

    @property
    def cells(self) -> tuple[int, int]:
        """How many faces the picture is wide and high."""
        placed = LAYOUTS[self.layout].values()
        return 1 + max(cell[0] for cell in placed), 1 + max(cell[1] for cell in placed)

    @property
    def aspect(self) -> float:
        """Width over height."""
        return self.cells[0] / self.cells[1]

    def directions(
        self, column: Coordinates, row: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Mask]:
        """See `Projection.directions`; a cell without a face is not valid."""
        size = self.face_size(width_px, height_px)
        column, row = np.broadcast_arrays(column, row)
        directions = np.zeros((*column.shape, 3), np.result_type(column, np.float32))
        directions[..., 2] = -1
        valid = np.zeros(column.shape, bool)
        for face, (cell_x, cell_y, turned) in LAYOUTS[self.layout].items():
            x = (column + 0.5) / size - cell_x
            y = (row + 0.5) / size - cell_y
            here = (x >= 0) & (x < 1) & (y >= 0) & (y < 1)
            x, y = x[here] * 2 - 1, 1 - y[here] * 2
            sign = -1 if turned else 1
            local = np.stack([sign * x, sign * y, np.full_like(x, -1.0)], axis=-1)
            local /= np.linalg.norm(local, axis=-1, keepdims=True)
            directions[here] = FACES[face].apply(local)
            valid |= here
        return directions, valid

    def pixel(
        self, directions: Coordinates, width_px: int, height_px: int
    ) -> tuple[Coordinates, Coordinates, Mask]:
        """See `Projection.pixel`; every direction is shown."""
        size = self.face_size(width_px, height_px)
        face, x, y = face_coordinates(directions)
        placed = [LAYOUTS[self.layout][name] for name in _ORDER]
        cell_x, cell_y, turned = (np.array(values)[face] for values in zip(*placed, strict=True))
        sign = np.where(turned, -1, 1).astype(x.dtype)
        column = ((sign * x + 1) / 2 + cell_x) * size - 0.5
        row = ((1 - sign * y) / 2 + cell_y) * size - 0.5
        dtype = directions.dtype
        return column.astype(dtype), row.astype(dtype), np.ones(column.shape, bool)

    def angle_per_pixel(self, width_px: int, height_px: int) -> float:
        """See `Projection.angle_per_pixel`; in the corners of a face."""
        return 2 / self.face_size(width_px, height_px) / 3

    def face_size(self, width_px: int, height_px: int) -> int:
        """The width of one face in a picture of this size.

        Raises:
            UsageError: If the picture is not a whole number of square faces.
        """
        wide, high = self.cells
        size = width_px // wide
        if size < 1 or (size * wide, size * high) != (width_px, height_px):
            raise UsageError(
                f"A cubemap as {self.layout} is {wide} by {high} square faces; "
                f"{width_px}x{height_px} is not."
            )
        return size


def face_coordinates(
    directions: Coordinates,
) -> tuple[NDArray[np.int64], Coordinates, Coordinates]:
    """Which face directions (..., 3) fall on, in the order of `FACES`, and where on it.

    Returns:
        (...) face numbers, and x to the right and y up on the face, -1 to 1.
    """
    x, y, z = directions[..., 0], directions[..., 1], directions[..., 2]
    east, high, north = np.abs(x), np.abs(y), np.abs(z)
    on_x = (east > north) & (east >= high)
    on_y = (high > north) & ~on_x
    face = np.where(on_x, np.where(x > 0, 0, 1), np.where(on_y, np.where(y > 0, 2, 3), 4))
    face = np.where(~on_x & ~on_y & (z > 0), 5, face)
    depth = np.maximum(np.where(on_x, east, np.where(on_y, high, north)), 1e-30)
    across = np.select([face == 0, face == 1, face == 5], [z, -z, -x], x)
    upward = np.select([face == 2, face == 3], [z, -z], y)
    return face, across / depth, upward / depth


def cubemap_directions(size_px: int, face: str) -> NDArray[np.float32]:
    """The unit direction behind each pixel of a face, (size_px, size_px, 3) float32."""
    return perspective_directions(size_px, size_px, 90.0, FACES[face])


def join_faces(faces: dict[str, NDArray[Any]], layout: str = "horizontal-cross") -> NDArray[Any]:
    """Six faces (s, s[, C]) in one picture; cells without a face are 0."""
    cubemap = Cubemap(layout=layout)
    if set(faces) != set(FACES):
        raise UsageError(f"A cubemap has the faces {', '.join(FACES)}, not {', '.join(faces)}.")
    first = faces["front"]
    size = first.shape[0]
    if any(face.shape != first.shape or face.shape[1] != size for face in faces.values()):
        raise UsageError("The faces of a cubemap are squares of one size.")
    wide, high = cubemap.cells
    picture = np.zeros((high * size, wide * size, *first.shape[2:]), first.dtype)
    for name, (x, y, turned) in LAYOUTS[layout].items():
        face = faces[name][::-1, ::-1] if turned else faces[name]
        picture[y * size : (y + 1) * size, x * size : (x + 1) * size] = face
    return picture


def split_faces(picture: NDArray[Any], layout: str = "horizontal-cross") -> dict[str, NDArray[Any]]:
    """The six faces (s, s[, C]) of a cubemap picture, as views of it."""
    height, width = picture.shape[:2]
    size = Cubemap(layout=layout).face_size(width, height)
    faces = {}
    for name in FACES:
        x, y, turned = LAYOUTS[layout][name]
        face = picture[y * size : (y + 1) * size, x * size : (x + 1) * size]
        faces[name] = face[::-1, ::-1] if turned else face
    return faces

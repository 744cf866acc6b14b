"""Triangle meshes of simple parts, gathered by the material they are made of.

Everything is built in a local frame, x right, y up, z toward the viewer, and carried into the
frame of the place by a `Placement`. All parts of one material become one mesh.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.synthetic.materials import Material

Floats = NDArray[np.float64]
# Points, corners or places in a picture: an array, or lists in the shape of one.
Points = NDArray[Any] | Sequence[Any]
_UNIT_UV = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
# The faces of a box as corners of its (x, y, z) bits, each counter-clockwise from outside.
_BOX_FACES = {
    "front": (1, 5, 7, 3),
    "back": (4, 0, 2, 6),
    "right": (5, 4, 6, 7),
    "left": (0, 1, 3, 2),
    "top": (3, 7, 6, 2),
    "bottom": (0, 4, 5, 1),
}


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """How a part's local frame lies in the frame of the place.

    Attributes:
        axes: (3, 3), the local axes as columns.
        origin: (3,), in meters.
    """

    axes: Floats
    origin: Floats

    @classmethod
    def standing(cls, x: float, z: float, turn: float = 0.0, y: float = 0.0) -> "Placement":
        """Upright at (x, y, z), turned by `turn` radians counter-clockwise from above."""
        cos, sin = np.cos(turn), np.sin(turn)
        axes = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
        return cls(axes, np.array([x, y, z], np.float64))

    def apply(self, points: Floats) -> Floats:
        """Local points (..., 3) in the frame of the place."""
        return np.asarray(points @ self.axes.T + self.origin)


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles of one material.

    Attributes:
        vertices: (N, 3) float32, meters.
        uv: (N, 2) float32.
        triangles: (M, 3) int32, counter-clockwise from outside.
    """

    vertices: NDArray[np.float32]
    uv: NDArray[np.float32]
    triangles: NDArray[np.int32]


@dataclass(slots=True)
class _Pile:
    vertices: list[Floats] = field(default_factory=list)
    uv: list[Floats] = field(default_factory=list)
    triangles: list[NDArray[Any]] = field(default_factory=list)
    count: int = 0


class Parts:
    """Gathers parts; `placed` gives the same heap seen from another local frame."""

    def __init__(self) -> None:
        self._piles: dict[Material, _Pile] = {}
        self._placement = Placement.standing(0, 0)

    def placed(self, placement: Placement) -> "Parts":
        """The same heap, filled through another local frame (relative to this one)."""
        view = Parts()
        view._piles = self._piles
        view._placement = Placement(
            self._placement.axes @ placement.axes, self._placement.apply(placement.origin)
        )
        return view

    def meshes(self) -> dict[Material, Mesh]:
        """One mesh for each material."""
        return {
            material: Mesh(
                np.concatenate(pile.vertices).astype(np.float32),
                np.concatenate(pile.uv).astype(np.float32),
                np.concatenate(pile.triangles).astype(np.int32),
            )
            for material, pile in self._piles.items()
        }

    def add(self, material: Material, vertices: Points, uv: Points, triangles: Points) -> None:
        """Add triangles with their own vertices."""
        points = self._placement.apply(np.asarray(vertices, np.float64).reshape(-1, 3))
        pile = self._piles.setdefault(material, _Pile())
        pile.vertices.append(points)
        pile.uv.append(np.asarray(uv, np.float64).reshape(-1, 2))
        pile.triangles.append(np.asarray(triangles).reshape(-1, 3) + pile.count)
        pile.count += len(points)

    def quads(self, material: Material, corners: Points, uv: Points | None = None) -> None:
        """Add quadrilaterals, corners (..., 4, 3) counter-clockwise from outside."""
        points = np.asarray(corners, np.float64).reshape(-1, 4, 3)
        count = len(points)
        where = np.broadcast_to(_UNIT_UV if uv is None else np.asarray(uv), (count, 4, 2))
        first = 4 * np.arange(count)[:, None]
        triangles = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
        self.add(material, points, where, triangles)

    def panel(
        self,
        material: Material,
        x: tuple[float, float],
        y: tuple[float, float],
        z: float,
        uv: Points | None = None,
    ) -> None:
        """Add an upright rectangle that faces +z."""
        (x0, x1), (y0, y1) = x, y
        self.quads(material, [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]], uv)

    def floor(
        self,
        material: Material,
        x: tuple[float, float],
        z: tuple[float, float],
        y: float = 0.0,
        meters_per_tile: float = 4.0,
    ) -> None:
        """Add a level rectangle that faces up; its texture repeats every few meters."""
        (x0, x1), (z0, z1) = x, z
        corners = np.array([[x0, y, z1], [x1, y, z1], [x1, y, z0], [x0, y, z0]])
        self.quads(material, corners, corners[:, [0, 2]] / meters_per_tile)

    def box(
        self,
        material: Material,
        low: Points,
        high: Points,
        omit: tuple[str, ...] = (),
        meters_per_tile: float = 4.0,
    ) -> None:
        """Add a box between two corners, without the faces named in `omit`."""
        ends = np.stack([np.asarray(low, np.float64), np.asarray(high, np.float64)])
        bits = np.arange(8)
        # Bit 2 is x, bit 1 is y, bit 0 is z.
        corners = np.stack(
            [ends[bits >> 2 & 1, 0], ends[bits >> 1 & 1, 1], ends[bits & 1, 2]], axis=1
        )
        for name, face in _BOX_FACES.items():
            if name not in omit:
                points = corners[list(face)]
                width = np.linalg.norm(points[1] - points[0])
                height = np.linalg.norm(points[3] - points[0])
                self.quads(material, points, _UNIT_UV * [width, height] / meters_per_tile)

    def grid(self, material: Material, points: Floats, *, closed: bool = False) -> None:
        """Add a surface over a grid of points (rows, columns, 3) with shared vertices.

        Counter-clockwise from outside means: columns grow to the right, rows grow up.
        """
        if closed:
            points = np.concatenate([points, points[:, :1]], axis=1)
        rows, columns = points.shape[:2]
        index = np.arange(rows * columns).reshape(rows, columns)
        a, b = index[:-1, :-1].ravel(), index[:-1, 1:].ravel()
        c, d = index[1:, 1:].ravel(), index[1:, :-1].ravel()
        triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
        u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
        self.add(material, points, np.stack([u, v], -1), triangles)

    def tube(
        self,
        material: Material,
        path: Points,
        radii: Points | float,
        sides: int = 10,
    ) -> None:
        """Add a round tube along a path of points, with a radius at each point; no end caps."""
        points = np.asarray(path, np.float64)
        along = np.gradient(points, axis=0)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        helper = np.array([0.0, 0, 1]) if abs(along[0, 2]) < 0.9 else np.array([1.0, 0, 0])
        side = np.cross(along, helper)
        side /= np.linalg.norm(side, axis=1, keepdims=True)
        other = np.cross(along, side)
        angle = -np.linspace(0, 2 * np.pi, sides, endpoint=False)
        ring = np.cos(angle)[None, :, None] * side[:, None] - np.sin(angle)[None, :, None] * (
            -other[:, None]
        )
        radius = np.broadcast_to(np.asarray(radii, np.float64), len(points))
        self.grid(material, points[:, None] + ring * radius[:, None, None], closed=True)

"""Closed solids that furniture is put together from: boxes, cushions, lathes and sweeps.

Every solid is watertight by itself and its triangles run counter-clockwise seen from outside.
An object is a heap of them: they may reach into each other and are not united.
"""

from collections.abc import Sequence
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.objects.creases import face_normals, split_creases, weld
from panokit.dataset.objects.shaping import centered
from panokit.dataset.scene import Mesh

Floats = NDArray[np.floating[Any]]
Faces = NDArray[np.int32]
Points = NDArray[Any] | Sequence[Any]


class Solids:
    """Gathers solids, each with the number of the part it belongs to.

    Built in any unit, y up; `mesh` centers the whole and makes its longest side 1 m.
    """

    def __init__(self) -> None:
        self._heap: list[tuple[int, Floats, Faces]] = []
        self._axes = np.eye(3)
        self._origin = np.zeros(3)

    def placed(
        self, origin: Points = (0, 0, 0), *, turn_deg: float = 0.0, lean_deg: float = 0.0
    ) -> "Solids":
        """The same heap, filled through another frame (relative to this one).

        Args:
            origin: Of the new frame.
            turn_deg: Counter-clockwise from above.
            lean_deg: About x, before the turn: an upright plank then leans toward +z.
        """
        turn, lean = np.deg2rad(turn_deg), np.deg2rad(lean_deg)
        about_y = np.array(
            [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
        )
        about_x = np.array(
            [[1, 0, 0], [0, np.cos(lean), -np.sin(lean)], [0, np.sin(lean), np.cos(lean)]]
        )
        view = Solids()
        view._heap = self._heap
        view._axes = self._axes @ about_y @ about_x
        view._origin = self._axes @ np.asarray(origin, np.float64) + self._origin
        return view

    def add(self, part: int, vertices: Points, faces: Points) -> None:
        """Add one closed solid with welded vertices; it is turned inside out if it has to be."""
        points = np.asarray(vertices, np.float64) @ self._axes.T + self._origin
        triangles = np.asarray(faces, np.int32)
        outward = np.einsum("ij,ij->", points[triangles[:, 0]], face_normals(points, triangles))
        self._heap.append((part, points, triangles if outward > 0 else triangles[:, ::-1]))

    def box(self, part: int, low: Points, high: Points, chamfer: float = 0.0) -> None:
        """Add a box between two corners, its edges cut off by `chamfer`."""
        ends = np.array([low, high], np.float64)
        half, middle = np.ptp(ends, axis=0) / 2, ends.mean(axis=0)
        cut = max(min(chamfer, 0.49 * 2 * half.min()), 1e-4 * half.min())
        signs, flat, faces = _chamfered()
        self.add(part, middle + signs * (half - cut * ~flat), faces)

    def cushion(
        self,
        part: int,
        low: Points,
        high: Points,
        radius: float,
        bulge: Points = (0.0, 0.0, 0.0),
    ) -> None:
        """Add a box with round edges, swollen by `bulge` in the middle of its faces."""
        ends = np.array([low, high], np.float64)
        half, middle = np.ptp(ends, axis=0) / 2, ends.mean(axis=0)
        radius = min(radius, 0.98 * half.min())
        core, outward, faces = _rounded(2, 3 if np.any(bulge) else 1)
        swell = np.stack(
            [(1 - core[:, (a + 1) % 3] ** 2) * (1 - core[:, (a + 2) % 3] ** 2) for a in range(3)], 1
        )
        points = core * (half - radius) + outward * radius
        points += np.sign(points) * np.abs(outward) * swell * np.asarray(bulge)
        self.add(part, middle + points, faces)

    def lathe(
        self, part: int, profile: Points, center: tuple[float, float] = (0, 0), segments: int = 24
    ) -> None:
        """Add a solid of revolution about an upright axis.

        Args:
            part: Which part it belongs to.
            profile: (radius, height) of points; either from the axis to the axis (first and
                last radius 0) or a closed loop beside it, whose last point joins the first.
            center: x and z of the axis.
            segments: Around the axis.
        """
        points = np.asarray(profile, np.float64)
        looped = points[0, 0] > 0
        ring = points if looped else points[1:-1]
        angle = np.arange(segments) / segments * 2 * np.pi
        around = np.stack([np.cos(angle), np.zeros(segments), np.sin(angle)], axis=1)
        grid = ring[:, :1, None] * around + ring[:, 1:, None] * np.array([0.0, 1, 0])
        grid = grid + np.array([center[0], 0, center[1]])
        poles = [] if looped else [[center[0], points[end, 1], center[1]] for end in (0, -1)]
        self.add(part, *_wound(grid, np.array(poles), looped))

    def sweep(self, part: int, path: Points, section: Points, scale: Points | float = 1.0) -> None:
        """Add a solid made by a cross section that travels along a path, capped at both ends.

        Args:
            part: Which part it belongs to.
            path: (N, 3), at least two points; or a loop, whose last point repeats the first.
            section: (M, 2) corners around the middle, across and along the frame that is
                carried on from point to point; it starts with the second axis as level up
                as it can be.
            scale: Of the section, at each point.
        """
        points = np.asarray(path, np.float64)
        looped = bool(np.allclose(points[0], points[-1]))
        points = points[:-1] if looped else points
        across, along = _frames(points, looped)
        size = np.broadcast_to(np.asarray(scale, np.float64), len(points))[:, None, None]
        outline = np.asarray(section, np.float64)
        offsets = across[:, None] * outline[:, :1] + along[:, None] * outline[:, 1:]
        grid = points[:, None] + offsets * size
        self.add(part, *_wound(grid, np.array([]) if looped else points[[0, -1]], looped))

    def tube(self, part: int, path: Points, radius: Points | float, sides: int = 12) -> None:
        """Add a round rod along a path, with one radius or one for each point."""
        self.sweep(part, path, round_section(1.0, sides), radius)

    def mesh(self, longest_m: float = 1.0) -> Mesh:
        """All of it as one smooth mesh with creases, centered, its longest side `longest_m`."""
        sizes = np.cumsum([0] + [len(points) for _, points, _ in self._heap])
        points = np.concatenate([points for _, points, _ in self._heap])
        faces = np.concatenate(
            [tri + first for (_, _, tri), first in zip(self._heap, sizes, strict=False)]
        )
        parts = np.concatenate([np.full(len(tri), part) for part, _, tri in self._heap])
        points, faces = split_creases(centered(points) * longest_m, faces)
        _, dense = np.unique(parts, return_inverse=True)
        return Mesh(
            vertices=points.astype(np.float32),
            faces=faces.astype(np.int32),
            part=dense.reshape(-1).astype(np.uint8),
            smooth=True,
        )


def round_section(radius: float, sides: int = 12) -> Floats:
    """The corners of a circle's polygon, for `Solids.sweep`."""
    angle = (np.arange(sides) + 0.5) / sides * 2 * np.pi
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def flat_section(width: float, height: float, chamfer: float = 0.0) -> Floats:
    """The corners of a rectangle with cut corners, for `Solids.sweep`."""
    x, y = width / 2, height / 2
    cut = min(max(chamfer, 0.02 * min(x, y)), 0.9 * min(x, y))
    return np.array(
        [
            [x, -y + cut], [x, y - cut], [x - cut, y], [-x + cut, y],
            [-x, y - cut], [-x, -y + cut], [-x + cut, -y], [x - cut, -y],
        ]
    )  # fmt: skip


def _wound(grid: Floats, poles: Floats, looped: bool) -> tuple[Floats, Faces]:
    """A tube over a grid of rings (rows, columns, 3), closed by two poles or upon itself."""
    rows, columns = grid.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    lower = index if looped else index[:-1]
    upper = np.roll(index, -1, axis=0) if looped else index[1:]
    a, b = lower, np.roll(lower, -1, axis=1)
    c, d = np.roll(upper, -1, axis=1), upper
    faces = [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    points = grid.reshape(-1, 3)
    if len(poles):
        first, last = rows * columns, rows * columns + 1
        bottom, top = index[0], index[-1]
        faces.append(np.stack([np.roll(bottom, -1), bottom, np.full(columns, first)], -1))
        faces.append(np.stack([top, np.roll(top, -1), np.full(columns, last)], -1))
        points = np.concatenate([points, poles])
    return points, np.concatenate(faces).astype(np.int32)


def _frames(points: Floats, looped: bool) -> tuple[Floats, Floats]:
    """Two axes across a path at each of its points, carried on without twist."""
    if looped:
        along = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    else:
        along = np.asarray(np.gradient(points, axis=0))
    ahead = along / np.linalg.norm(along, axis=1, keepdims=True)
    up = np.array([0.0, 1, 0]) if abs(ahead[0, 1]) < 0.9 else np.array([0.0, 0, 1])
    first, second = [], []
    for direction in ahead:
        across = np.cross(direction, up)
        across /= np.linalg.norm(across)
        up = np.cross(across, direction)
        first.append(across)
        second.append(up)
    return np.array(first), np.array(second)


@lru_cache(maxsize=1)
def _chamfered() -> tuple[Floats, NDArray[np.bool_], Faces]:
    """A chamfered box: signs (24, 3), along which axis each vertex is not cut, and faces."""
    corners = np.array(list(product((-1, 1), repeat=3)), np.float64)
    signs = np.repeat(corners, 3, axis=0)
    flat = np.tile(np.eye(3, dtype=bool), (8, 1))

    def at(corner: Sequence[int], axis: int) -> int:
        return 3 * int(((np.array(corner) + 1) // 2) @ [4, 2, 1]) + axis

    loops: list[list[int]] = []
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        around = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        for sign in (-1, 1):
            loops.append([at(_corner(axis, sign, one, u, two, v), axis) for u, v in around])
        for u, v in around:
            ends = [_corner(axis, sign, one, u, two, v) for sign in (-1, 1)]
            loops.append([at(ends[0], one), at(ends[1], one), at(ends[1], two), at(ends[0], two)])
    loops += [[3 * corner, 3 * corner + 1, 3 * corner + 2] for corner in range(8)]
    points = signs * (1 - 0.2 * ~flat)
    faces = []
    for loop in loops:
        for k in range(1, len(loop) - 1):
            a, b, c = points[[loop[0], loop[k], loop[k + 1]]]
            turned = np.dot(np.cross(b - a, c - a), a + b + c) < 0
            faces.append([loop[0], loop[k + 1], loop[k]] if turned else [loop[0], *loop[k : k + 2]])
    return signs, flat, np.array(faces, np.int32)


def _corner(axis: int, sign: int, one: int, u: int, two: int, v: int) -> list[int]:
    corner = [0, 0, 0]
    corner[axis], corner[one], corner[two] = sign, u, v
    return corner


@lru_cache(maxsize=4)
def _rounded(round_steps: int, flat_steps: int) -> tuple[Floats, Floats, Faces]:
    """A round box: the core point of each vertex in [-1, 1]^3, its way out of it, and faces."""
    rise = np.tan(np.pi / 4 * (1 - np.arange(round_steps + 1) / round_steps))
    flat = np.linspace(-1, 1, flat_steps + 1)
    core = np.concatenate([-np.ones(round_steps), flat, np.ones(round_steps)])
    tilt = np.concatenate([-rise[:-1], np.zeros(flat_steps + 1), rise[:-1][::-1]])
    count = len(core)
    u, v = np.meshgrid(np.arange(count), np.arange(count))
    index = np.arange(count * count).reshape(count, count)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    quads = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    cores: list[Floats] = []
    ways: list[Floats] = []
    faces: list[NDArray[Any]] = []
    for axis, sign in product(range(3), (-1, 1)):
        center, way = np.empty((count, count, 3)), np.empty((count, count, 3))
        for values, source, edge in ((center, core, sign), (way, tilt, sign)):
            values[..., axis] = edge
            values[..., (axis + 1) % 3] = source[u]
            values[..., (axis + 2) % 3] = source[v]
        faces.append((quads if sign > 0 else quads[:, ::-1]) + len(cores) * count * count)
        cores.append(center.reshape(-1, 3))
        ways.append(way.reshape(-1, 3))
    out = np.concatenate(ways)
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    both, joined = weld(np.hstack([np.concatenate(cores), out]), np.concatenate(faces), 1e-6)
    return both[:, :3], both[:, 3:], joined.astype(np.int32)

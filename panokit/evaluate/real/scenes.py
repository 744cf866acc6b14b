"""One object in one place: photographs with poses, and the light that was measured there."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import Rotation

Picture = NDArray[np.float32]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RealView:
    """One photograph.

    Attributes:
        name: In its scene.
        intrinsics: (3, 3), in pixels; pixel edges at integers, rows down.
        width_px: Of the photograph.
        height_px: Of the photograph.
        world_from_camera: Its axes: right, up and back.
        position: (3,), in the scene's unit of length.
        read: Gives linear radiance (H, W, 3) float32 and coverage (H, W) float32 in [0, 1].
        read_normals: Gives normals (h, w, 3) in this camera's frame, 0 off the object, at any
            size; or None.
    """

    name: str
    intrinsics: NDArray[np.float64]
    width_px: int
    height_px: int
    world_from_camera: Rotation
    position: NDArray[np.float64]
    read: Callable[[], tuple[Picture, Picture]]
    read_normals: Callable[[], Picture] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeasuredLight:
    """Light as it was measured.

    Attributes:
        name: Of the map.
        world_from_map: Turns directions of the map's frame, in panokit's axes, into the world's.
        read: Gives radiance (H, W, 3) float32, W == 2 H, on the scale of the photographs if that
            is known.
    """

    name: str
    world_from_map: Rotation
    read: Callable[[], Picture]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RealScene:
    """An object in one place, its light unchanged.

    Attributes:
        object: Which.
        place: Where.
        views: With poses in one world, +Y up if `upright`.
        center: (3,), about where the object is.
        lights: One map or several, of the same light.
        metered: Whether the photographs are HDR, so that an exposure is to be chosen; else 1.0 is
            their white.
        scale_known: Whether maps and photographs have one scale.
        upright: Whether the world's +Y is up.
    """

    object: str
    place: str
    views: tuple[RealView, ...]
    center: NDArray[np.float64]
    lights: tuple[MeasuredLight, ...]
    metered: bool
    scale_known: bool
    upright: bool = True

    def light_near(self, view: RealView) -> MeasuredLight:
        """The map whose frame is turned least against the view."""
        inverse = view.world_from_camera.inverse
        return min(self.lights, key=lambda light: (inverse @ light.world_from_map).angle)


def nearest_rotation(matrix: NDArray[np.float64]) -> Rotation:
    """The rotation nearest to a (3, 3) matrix that is one but for rounding and scale.

    The orthogonal Procrustes problem (Schoenemann 1966).
    """
    u, _, v = np.linalg.svd(matrix)
    return Rotation(np.asarray(u @ v))


def look_together_at(views: Sequence[RealView]) -> NDArray[np.float64]:
    """The point nearest to where all cameras look, (3,): least squares of distances to rays.

    Raises:
        UsageError: If there are fewer than two directions.
    """
    matrix, vector = np.zeros((3, 3)), np.zeros(3)
    for view in views:
        forward = -view.world_from_camera.matrix[:, 2]
        across = np.eye(3) - np.outer(forward, forward)
        matrix += across
        vector += across @ view.position
    if np.linalg.matrix_rank(matrix, tol=1e-6) < 3:
        raise UsageError("The cameras all look one way, so where the object is cannot be told.")
    return np.asarray(np.linalg.solve(matrix, vector))

"""Pictures of the scenes under a map, and the linear operator that makes them."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.equirectangular import check_equirectangular
from panokit.errors import ImageError, UsageError
from panokit.metrics.transport.ball import ball_steps, disc_alpha, mirror
from panokit.metrics.transport.linear import Step
from panokit.metrics.transport.plane import plane_steps
from panokit.metrics.transport.scenes import MIRROR_BALLS, PLANE, ROUGH_BALLS, SCENES
from panokit.metrics.transport.tables import plane_table

BALL_SIZE_PX = 128


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Transport:
    """The linear map from a light map to the picture of one scene.

    Attributes:
        scene: One of `SCENES`.
        map_width_px: Of the maps it takes; they are half as high.
        alpha: (size, size) float32, the share of each pixel that the object covers.
        steps: The chain that it is made of.
    """

    scene: str
    map_width_px: int
    alpha: NDArray[np.float32]
    steps: tuple[Step, ...]

    @property
    def size_px(self) -> int:
        """Width and height of the picture."""
        return int(self.alpha.shape[0])

    def forward(self, radiance: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
        """The picture, (size, size, C) float32, not multiplied by alpha.

        Args:
            radiance: (H, W, C) of the width above, linear; any sign, since gradients and
                differences of maps pass through here too.
        """
        shape = (self.map_width_px // 2, self.map_width_px)
        values = _checked(radiance, shape, "map")
        for step in self.steps:
            values = step.forward(values)
        return values

    def adjoint(self, image: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
        """The gradient with respect to the map of sum(image * forward(map)).

        Args:
            image: (size, size, C), the gradient of some loss with respect to the picture.

        Returns:
            (H, W, C) float32.
        """
        values = _checked(image, self.alpha.shape, "picture")
        for step in reversed(self.steps):
            values = step.adjoint(values)
        return values


def _checked(
    values: NDArray[np.floating[Any]], shape: tuple[int, ...], what: str
) -> NDArray[np.float32]:
    if values.ndim != 3 or values.shape[:2] != shape:
        raise UsageError(
            f"This transport takes a {what} of shape {(*shape, 3)}, not {values.shape}. "
            "Make one for your size with panokit.metrics.transport.transport."
        )
    return np.ascontiguousarray(values, np.float32)


@lru_cache(maxsize=16)
def transport(scene: str, map_width_px: int, size_px: int | None = None) -> Transport:
    """The operator of a scene for maps of one size; kept, since making it takes a second or two.

    Args:
        scene: One of `SCENES`.
        map_width_px: Of the maps; even, 16 or more.
        size_px: Width and height of the picture, 4 to 2048; 128 when not given.

    Raises:
        UsageError: If there is no such scene or size.
    """
    if map_width_px < 16 or map_width_px % 2:
        raise UsageError(f"A map is 16 pixels wide or more, and even, not {map_width_px}.")
    steps: tuple[Step, ...]
    requested = size_px
    size_px = BALL_SIZE_PX if requested is None else requested
    if scene in ROUGH_BALLS:
        alpha, steps = disc_alpha(size_px), ball_steps(scene, map_width_px, size_px)
    elif scene in MIRROR_BALLS:
        reflectance = MIRROR_BALLS[scene].normal_reflectance
        alpha, steps = disc_alpha(size_px), (mirror(map_width_px, size_px, reflectance),)
    elif scene == PLANE:
        side = plane_table().size_px
        if requested not in (None, side):
            raise UsageError(f"The plane scene is {side} pixels wide, not {requested}.")
        alpha, steps = np.ones((side, side), np.float32), plane_steps(map_width_px)
    else:
        raise UsageError(f"There is no scene {scene!r}; the scenes are {', '.join(SCENES)}.")
    return Transport(scene=scene, map_width_px=map_width_px, alpha=alpha, steps=steps)


def relight(
    radiance: NDArray[np.floating[Any]], scene: str, size_px: int | None = None
) -> NDArray[np.float32]:
    """A scene under the light of a map.

    Args:
        radiance: (H, W, 3) linear, equirectangular, floating point.
        scene: One of `SCENES`.
        size_px: Width and height of the picture; 128 when not given.

    Returns:
        (size, size, 4) float32: linear radiance in the map's unit, not multiplied by alpha,
        and alpha.

    Raises:
        ImageError: If the map is not an equirectangular picture of finite floats.
        UsageError: If there is no such scene or size.
    """
    radiance = np.asarray(radiance)
    check_equirectangular(radiance)
    if not np.issubdtype(radiance.dtype, np.floating):
        raise ImageError(
            f"Light is linear floating point, not {radiance.dtype}. Decode display values with "
            "panokit.color.srgb_decode.",
            reason="wrong-dtype",
        )
    if not np.isfinite(radiance.sum(dtype=np.float64)):
        raise ImageError(
            "The map has infinite or undefined values. Repair it where it was made, or read it "
            "with repair=True.",
            reason="not-physical",
        )
    operator = transport(scene, int(radiance.shape[1]), size_px)
    picture = operator.forward(radiance)
    return np.concatenate([picture, operator.alpha[..., None]], axis=-1)

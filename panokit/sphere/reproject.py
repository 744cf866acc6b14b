"""Any projection to any other, without aliasing; views and faces out of a sphere."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.sphere.cubemap import FACES
from panokit.sphere.equirect import Equirectangular
from panokit.sphere.perspective import Perspective
from panokit.sphere.pixel_map import Interpolation, PixelMap, apply_map, pixel_map
from panokit.sphere.projection import Projection
from panokit.sphere.resample import resize_radiance

# Below this many source pixels in one target pixel, interpolation alone looks right.
_COARSER = 1.5
_SUPERSAMPLES_MAX = 4
_SMALLEST_COPY_PX = 16


def reproject(
    picture: NDArray[Any],
    source: Projection,
    target: Projection,
    width_px: int,
    *,
    height_px: int | None = None,
    target_from_source: Rotation | None = None,
    interpolation: Interpolation = "linear",
    antialias: bool = True,
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """A picture in another projection.

    Where the target shows the source smaller than it is, equirectangular sources are read
    from reduced copies that keep their energy (a mipmap), others at several places a pixel.
    Radiance that must keep its energy exactly goes through `rotate_radiance` and
    `resize_radiance`, which only the equirectangular projection has.

    Args:
        picture: (H, W) or (H, W, C), uint8 or float32.
        source: Its projection.
        target: The projection wanted.
        width_px: Of the result.
        height_px: Of the result; if not given, from the target's aspect.
        target_from_source: What is at direction d in the source is at
            `target_from_source.apply(d)` in the target.
        interpolation: As of `apply_map`.
        antialias: Off: take every target pixel from one place, whatever the sizes.

    Returns:
        The picture (h, w) or (h, w, C) in the source's dtype, 0 where it shows nothing, and
        (h, w) bool where it shows something.

    Raises:
        UsageError: If a size does not fit its projection, or the dtype is another.
    """
    if picture.ndim not in (2, 3) or 0 in picture.shape:
        raise UsageError(f"A picture is (H, W) or (H, W, C) with pixels, not {picture.shape}.")
    height_px = max(1, round(width_px / target.aspect)) if height_px is None else height_px
    if width_px < 1 or height_px < 1:
        raise UsageError(f"A picture has at least one pixel, not {width_px}x{height_px}.")
    height, width = picture.shape[:2]
    size, target_size = (width, height), (width_px, height_px)
    found = pixel_map(source, size, target, target_size, target_from_source)
    coarseness = _coarseness(source, size, target, target_size)
    if interpolation == "nearest" or not antialias or coarseness.max() <= _COARSER:
        made = apply_map(picture, found, interpolation=interpolation)
    elif isinstance(source, Equirectangular) and width == 2 * height:
        made = _from_mipmap(picture, found, coarseness, interpolation)
    else:
        times = int(np.clip(np.ceil(np.percentile(coarseness, 90)), 2, _SUPERSAMPLES_MAX))
        fine_size = (width_px * times, height_px * times)
        fine = apply_map(
            picture, pixel_map(source, size, target, fine_size, target_from_source),
            interpolation=interpolation,
        )  # fmt: skip
        made = cv2.resize(fine, target_size, interpolation=cv2.INTER_AREA)
    made[~found.valid] = 0
    return made, found.valid


def perspective_view(
    picture: NDArray[Any],
    width_px: int,
    height_px: int,
    fov_deg: float,
    sphere_from_camera: Rotation | None = None,
    *,
    interpolation: Interpolation = "linear",
) -> NDArray[Any]:
    """What a pinhole camera sees of an equirectangular picture (H, W[, C]), uint8 or float32.

    Views much coarser than the picture alias; `reproject` does not.
    """
    pose = sphere_from_camera or Rotation.identity()
    view = Perspective(fov_deg=fov_deg, sphere_from_camera=pose)
    size = (picture.shape[1], picture.shape[0])
    found = pixel_map(Equirectangular(), size, view, (width_px, height_px))
    return apply_map(picture, found, interpolation=interpolation)


def cubemap_faces(
    picture: NDArray[Any], size_px: int, *, interpolation: Interpolation = "linear"
) -> dict[str, NDArray[Any]]:
    """The six faces of an equirectangular picture, each (size_px, size_px[, C]).

    A face is exactly 90 degrees wide between the outer edges of its outer pixels. Faces much
    coarser than the picture alias; `reproject` to a `Cubemap` does not.
    """
    return {
        face: perspective_view(picture, size_px, size_px, 90.0, pose, interpolation=interpolation)
        for face, pose in FACES.items()
    }


def _coarseness(
    source: Projection,
    source_size: tuple[int, int],
    target: Projection,
    target_size: tuple[int, int],
) -> NDArray[np.float32]:
    """How many source pixels one target pixel spans; (h, w), or smaller for a big target."""
    width, height = target_size
    # The span changes slowly over the picture: a coarse grid of pixels is enough.
    column = np.linspace(0, width - 1, min(width, 128))[None, :]
    row = np.linspace(0, height - 1, min(height, 128))[:, None]
    here, valid = target.directions(column, row, width, height)
    spans = []
    for x, y in ((0.25, 0), (0, 0.25)):
        # The nearer of two neighbors: the other may be on another face of a cube.
        steps = [
            np.linalg.norm(target.directions(column + s * x, row + s * y, width, height)[0] - here,
                           axis=-1)
            for s in (-1, 1)
        ]  # fmt: skip
        spans.append(4 * np.minimum(*steps))
    span = np.maximum(*spans) / source.angle_per_pixel(*source_size)
    return np.where(valid, span, 0).astype(np.float32)


def _from_mipmap(
    picture: NDArray[Any],
    found: PixelMap,
    coarseness: NDArray[np.float32],
    interpolation: Interpolation,
) -> NDArray[Any]:
    height, width = found.column.shape
    level: NDArray[Any] = cv2.resize(np.log2(np.maximum(coarseness, 1)), (width, height))
    # Coarser copies have too few pixels for a border; only the rim of a ball would want them.
    top = max(0, int(np.log2(picture.shape[0] / _SMALLEST_COPY_PX)))
    level = np.clip(level, 0, top)
    result = np.zeros((height, width, *picture.shape[2:]), np.float32)
    reduced = picture
    for number in range(int(np.ceil(level.max())) + 1):
        if number:
            if reduced.shape[1] % 4:
                break
            reduced = _halved(reduced)
        share = np.maximum(1 - np.abs(level - number), 0)
        if reduced.shape[1] % 4:
            # No further halving: everything coarser reads this one.
            share = np.where(level > number, 1, share)
        if share.any():
            here = _at_level(found, reduced, number)
            values = apply_map(reduced, here, interpolation=interpolation)
            result += (share if values.ndim == 2 else share[..., None]) * values
    if picture.dtype == np.uint8:
        return np.clip(np.rint(result), 0, 255).astype(np.uint8)
    return result


def _at_level(found: PixelMap, reduced: NDArray[Any], number: int) -> PixelMap:
    scale = np.float32(0.5**number)
    return PixelMap(
        source=found.source,
        source_width_px=reduced.shape[1],
        source_height_px=reduced.shape[0],
        column=(found.column + np.float32(0.5)) * scale - np.float32(0.5),
        row=(found.row + np.float32(0.5)) * scale - np.float32(0.5),
        valid=found.valid,
        border_px=found.border_px,
    )


def _halved(picture: NDArray[Any]) -> NDArray[Any]:
    height, width = picture.shape[:2]
    if picture.dtype == np.uint8:
        return cv2.resize(picture, (width // 2, height // 2), interpolation=cv2.INTER_AREA)
    deep = picture if picture.ndim == 3 else picture[..., None]
    halved = resize_radiance(deep, width // 2)
    return halved.reshape(height // 2, width // 2, *picture.shape[2:])

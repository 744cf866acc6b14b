"""Two photographs as a pair of parallel cameras would have taken them.

A camera that is only turned sees the same things: a photograph can be turned into that of any
camera at the same place, as far as it reaches (Fusiello et al. 2000, "A compact algorithm for
rectification of stereo pairs").
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError
from panokit.evaluate.real.pairs import RealPair
from panokit.evaluate.real.scenes import Picture, RealView
from panokit.evaluate.real.settings import PairSettings
from panokit.frames import Rotation

_HALF = 0.5
_WIDEST_DEG = 100.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cutout:
    """What one camera of the pair sees.

    Attributes:
        radiance: (S, S, 3) float32, linear; 0 where the photograph does not reach.
        coverage: (S, S) float32, of the object.
        known: (S, S) bool, where the photograph reaches.
        normals: (S, S, 3) float32 in this camera's frame; 0 where they are not known.
    """

    radiance: Picture
    coverage: Picture
    known: NDArray[np.bool_]
    normals: Picture


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rig:
    """Where the cameras of the pair look.

    Attributes:
        left: `world_from_camera` of the left one.
        right: The same of the right one; equal if they are parallel.
        fov_deg: From the left to the right edge, of both.
    """

    left: Rotation
    right: Rotation
    fov_deg: float


def rig_of(
    pair: RealPair,
    center: NDArray[np.float64],
    coverages: tuple[Picture, Picture],
    settings: PairSettings,
) -> Rig:
    """The cameras for a pair: how they are turned, and how wide they look.

    Parallel cameras have the line between the two places as their right and look at the object's
    center as far as that allows.

    Raises:
        ImageError: If a mask is empty, or the object too large for a picture.
    """
    turns = (pair.left.world_from_camera, pair.right.world_from_camera)
    if settings.rectify:
        parallel = _parallel(pair, center)
        turns = (parallel, parallel)
    widest = 0.0
    for view, turn, coverage in zip((pair.left, pair.right), turns, coverages, strict=True):
        rows, columns = np.nonzero(coverage > _HALF)
        if not len(rows):
            raise ImageError(
                f"The mask of {view.name} is empty: there is no object in it.", reason="blank-mask"
            )
        places = _rays(view, columns + 0.5, rows + 0.5, turn)
        if (places[:, 2] >= -1e-3).any():
            raise ImageError(f"{view.name} looks away from the object.", reason="too-large")
        widest = max(widest, float(np.abs(places[:, :2] / places[:, 2:]).max()))
    fov_deg = float(np.degrees(2 * np.arctan(widest / settings.fill)))
    if fov_deg > _WIDEST_DEG:
        raise ImageError(
            f"The object of {pair.left.name} would need a picture {fov_deg:.0f} degrees wide.",
            reason="too-large",
            values={"fov_deg": fov_deg},
        )
    return Rig(left=turns[0], right=turns[1], fov_deg=fov_deg)


def _parallel(pair: RealPair, center: NDArray[np.float64]) -> Rotation:
    right = pair.right.position - pair.left.position
    right = right / np.linalg.norm(right)
    toward = center - (pair.left.position + pair.right.position) / 2
    back = -(toward - (toward @ right) * right)
    back = back / np.linalg.norm(back)
    return Rotation(np.stack([right, np.cross(back, right), back], axis=1))


def _rays(
    view: RealView, column: NDArray[np.floating], row: NDArray[np.floating], turn: Rotation
) -> NDArray[np.float64]:
    """The directions of pixels of a photograph (N, 3) in the frame of a camera turned so."""
    points = np.stack([column, row, np.ones_like(column)], axis=-1)
    local = points @ np.linalg.inv(view.intrinsics).T * [1, -1, -1]
    return np.asarray((turn.inverse @ view.world_from_camera).apply(local))


def cut_out(
    view: RealView,
    radiance: Picture,
    coverage: Picture,
    turn: Rotation,
    fov_deg: float,
    width_px: int,
) -> Cutout:
    """A photograph as a camera at the same place sees it that is turned otherwise.

    Args:
        view: The photograph.
        radiance: (H, W, 3), of it.
        coverage: (H, W), of it.
        turn: `world_from_camera` of the new camera.
        fov_deg: Of the new camera.
        width_px: Width and height of its picture.
    """
    focal = width_px / 2 / np.tan(np.deg2rad(fov_deg) / 2)
    at = (np.arange(width_px) + 0.5 - width_px / 2) / focal
    x, y = np.meshgrid(at, -at)
    rays = np.stack([x, y, -np.ones_like(x)], axis=-1)
    local = (view.world_from_camera.inverse @ turn).apply(rays) * [1, -1, -1]
    pixel = local @ view.intrinsics.T
    ahead = pixel[..., 2] > 1e-6
    depth = np.where(ahead, pixel[..., 2], 1)
    column, row = pixel[..., 0] / depth, pixel[..., 1] / depth
    known = ahead & (column >= 0) & (row >= 0)
    known &= (column <= view.width_px) & (row <= view.height_px)
    # Made smaller first, as much as does not blur: a picture of few pixels read at points aliases.
    factor = max(1, int(view.intrinsics[0, 0] / focal))
    place = column / factor - 0.5, row / factor - 0.5
    premultiplied = _read(_reduced(radiance, factor), place)
    normals = np.zeros((width_px, width_px, 3), np.float32)
    if view.read_normals is not None:
        given = np.asarray(view.read_normals(), np.float32)
        scale = given.shape[1] / view.width_px
        near = column * scale - 0.5, row * scale - 0.5
        seen = _read(given, near, cv2.INTER_NEAREST)
        turned = (turn.inverse @ view.world_from_camera).apply(seen.astype(np.float64))
        length = np.linalg.norm(turned, axis=-1, keepdims=True)
        normals = np.where(length > _HALF, turned / np.maximum(length, 1e-6), 0).astype(np.float32)
    covered = _read(_reduced(coverage, factor), place)
    return Cutout(
        radiance=np.where(known[..., None], premultiplied, 0).astype(np.float32),
        coverage=np.where(known, covered, 0).astype(np.float32),
        known=known,
        normals=np.where(known[..., None], normals, 0).astype(np.float32),
    )


def _reduced(picture: Picture, factor: int) -> Picture:
    if factor == 1:
        return picture
    size = (max(1, picture.shape[1] // factor), max(1, picture.shape[0] // factor))
    # Whole blocks only, so that a pixel is exactly `factor` pixels wide.
    whole = picture[: size[1] * factor, : size[0] * factor]
    return np.asarray(cv2.resize(whole, size, interpolation=cv2.INTER_AREA), np.float32)


def _read(
    picture: Picture,
    place: tuple[NDArray[np.float64], NDArray[np.float64]],
    how: int = cv2.INTER_LINEAR,
) -> Picture:
    column, row = (one.astype(np.float32) for one in place)
    return np.asarray(
        cv2.remap(picture, column, row, how, borderMode=cv2.BORDER_REPLICATE), np.float32
    )

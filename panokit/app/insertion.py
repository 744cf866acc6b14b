"""Relit balls in a frame of a video: what the light that was read looks like on something else.

Two balls stand beside the object, about as high as it: a light gray one and a mirror. They are
lit by the map through `panokit.metrics.transport`; the ground under them, a level plane through
the object's lowest point, loses the light that they keep from it (differential rendering, Debevec
1998, with the ground's own picture for its albedo). The balls are seen from where they stand, so
the mirror shows what would be seen in it there.
"""

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance, srgb_encode_u8
from panokit.color.transfer import srgb_decode_u8
from panokit.frames import Rotation
from panokit.metrics.transport import Transport, transport
from panokit.sphere import equirect_directions, resize_radiance, rotate_radiance, row_solid_angles

# Scene of `panokit.metrics.transport` -> the share of its light that is shown: a white ball would
# be burnt wherever the frame's own white is, so the diffuse one is gray.
BALLS = {"principled-diffuse": 0.55, "mirror-silver": 1.0}
# Widths: of a ball's picture, of the map that lights it, of the map that shadows are cast from,
# of the picture of the shadows.
_BALL_PX, _MAP_PX, _LIGHTS_PX, _SHADE_PX = 192, 256, 48, 160
# Nothing stands nearer to its neighbor than this share of the balls' size.
_GAP = 0.25
# In radii of a ball: half the width of a shadow's edge, and how far away its shadow is looked for.
_SOFT, _REACH = 0.12, 12.0
# A ball's height, in parts of the frame's.
_LARGEST, _SMALLEST = 0.34, 0.1


def warm_up() -> None:
    """Make what takes a second or two when balls are lit for the first time."""
    for scene in BALLS:
        _ball(scene)


def insert_balls(
    picture: NDArray[np.uint8],
    mask: NDArray[np.bool_],
    radiance: NDArray[np.float32],
    level_from_camera: Rotation,
    fov_deg: float,
) -> NDArray[np.uint8]:
    """A frame with two relit balls beside its object.

    Args:
        picture: (H, W, 3) uint8, display-encoded.
        mask: (H, W) bool, the object.
        radiance: (h, 2 h, 3) float32 linear, in the camera's frame, 1.0 is the picture's white.
        level_from_camera: Which way is up.
        fov_deg: From the left to the right edge of the picture.

    Returns:
        (H, W, 3) uint8.
    """
    height, width = mask.shape
    focal = width / 2 / np.tan(np.deg2rad(fov_deg) / 2)
    places = _places(mask)
    balls = [_stood(center, size, (width, height), focal) for center, size in places]
    linear = srgb_decode_u8(picture).astype(np.float32)
    up = level_from_camera.matrix.T @ np.array([0.0, 1.0, 0.0])
    shade = _shade(balls, radiance, up, (width, height), focal)
    linear *= np.where(mask, 1.0, shade)[..., None].astype(np.float32)
    small = resize_radiance(radiance, _MAP_PX) if radiance.shape[1] != _MAP_PX else radiance
    for (scene, gain), (center, size), stood in zip(BALLS.items(), places, balls, strict=True):
        seen = np.asarray(rotate_radiance(small, _toward(stood)) * np.float32(gain), np.float32)
        _lay(linear, _ball(scene).forward(seen), _ball(scene).alpha, center, size)
    return srgb_encode_u8(np.clip(linear, 0, None))


@lru_cache(maxsize=2)
def _ball(scene: str) -> Transport:
    return transport(scene, _MAP_PX, _BALL_PX)


def _places(mask: NDArray[np.bool_]) -> list[tuple[tuple[float, float], float]]:
    """Center and diameter in pixels of two balls: on both sides of the object, or where room is."""
    height, width = mask.shape
    rows, columns = np.nonzero(mask)
    left, right, bottom = float(columns.min()), float(columns.max() + 1), float(rows.max() + 1)
    tall = bottom - float(rows.min())
    size = float(np.clip(0.7 * tall, _SMALLEST * height, _LARGEST * height))
    bottom = float(np.clip(bottom, size, height - 0.02 * height))
    room = (left, width - right)
    need = (1 + _GAP) * size
    middle = bottom - size / 2
    if min(room) >= need:
        spots = [left - (_GAP + 0.5) * size, right + (_GAP + 0.5) * size]
    else:
        sign, edge = (-1, left) if room[0] > room[1] else (1, right)
        size = min(size, max(room) / (2 * (1 + _GAP)))
        middle = bottom - size / 2
        spots = sorted(edge + sign * size * (_GAP + 0.5 + one * (1 + _GAP)) for one in (0, 1))
    return [((spot, middle), size) for spot in spots]


def _stood(
    center: tuple[float, float], size: float, frame: tuple[int, int], focal: float
) -> NDArray[np.float64]:
    """Where a ball of radius 1 is, in the camera's frame, to be seen at a place and size."""
    across, down = center[0] - frame[0] / 2, center[1] - frame[1] / 2
    direction = np.array([across, -down, -focal]) / np.hypot(np.hypot(across, down), focal)
    return np.asarray(direction * (2 * focal / size), np.float64)


def _toward(ball: NDArray[np.float64]) -> Rotation:
    """From the camera's frame to one that looks at the ball."""
    ahead = ball / np.linalg.norm(ball)
    right = np.cross(ahead, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    return Rotation(np.stack([right, np.cross(right, ahead), -ahead]))


def _shade(
    balls: list[NDArray[np.float64]],
    radiance: NDArray[np.float32],
    up: NDArray[np.float64],
    frame: tuple[int, int],
    focal: float,
) -> NDArray[np.float32]:
    """What share of its light each point of the ground keeps, (H, W); 1 above the horizon."""
    small_width = min(_SHADE_PX, frame[0])
    scale = small_width / frame[0]
    small_height = max(1, round(frame[1] * scale))
    columns, rows = np.meshgrid(np.arange(small_width) + 0.5, np.arange(small_height) + 0.5)
    rays = np.stack(
        [columns / scale - frame[0] / 2, frame[1] / 2 - rows / scale, np.full_like(rows, -focal)],
        axis=-1,
    ).reshape(-1, 3)
    falling = rays @ up
    ground = np.mean([ball @ up for ball in balls]) - 1.0
    share = np.ones(len(rays))
    seen = (falling < -1e-6) if ground < 0 else np.zeros(len(rays), bool)
    if seen.any():
        distance = ground / falling[seen]
        points = rays[seen] * distance[:, None]
        near = np.min([np.linalg.norm(points - ball, axis=1) for ball in balls], axis=0) < _REACH
        share[np.flatnonzero(seen)[near]] = _kept(points[near], balls, radiance, up)
    small = share.reshape(small_height, small_width).astype(np.float32)
    return np.asarray(cv2.resize(small, frame, interpolation=cv2.INTER_LINEAR), np.float32)


def _kept(
    points: NDArray[np.float64],
    balls: list[NDArray[np.float64]],
    radiance: NDArray[np.float32],
    up: NDArray[np.float64],
) -> NDArray[np.float64]:
    """What share of its light each point (N, 3) of the ground keeps, (N,); balls have radius 1."""
    height = _LIGHTS_PX // 2
    light = luminance(resize_radiance(radiance, _LIGHTS_PX)).reshape(-1).astype(np.float64)
    toward = equirect_directions(_LIGHTS_PX, height).reshape(-1, 3)
    fall = np.clip(toward @ up, 0, None)
    weight = light * fall * np.repeat(row_solid_angles(height), _LIGHTS_PX)
    whole = weight.sum()
    if whole <= 0:
        return np.ones(len(points))
    # What gives next to nothing is not worth a ray.
    used = weight > 1e-4 * weight.max()
    toward, weight = toward[used], weight[used]
    open_ = np.ones((len(points), len(toward)))
    for ball in balls:
        away = ball - points
        along = away @ toward.T
        beside = np.sqrt(np.maximum((away**2).sum(axis=1)[:, None] - along**2, 0))
        # Lights are patches, not points: their shadows have soft edges.
        hidden = np.clip((1 + _SOFT - beside) / (2 * _SOFT), 0, 1) * (along > 0)
        open_ *= 1 - hidden
    return np.asarray(open_ @ weight / weight.sum())


def _lay(
    linear: NDArray[np.float32],
    ball: NDArray[np.float32],
    alpha: NDArray[np.float32],
    center: tuple[float, float],
    size: float,
) -> None:
    """Lay a picture of a ball over a part of another, in place; center and size in its pixels."""
    scale = size / ball.shape[0]
    shift = np.array(
        [[scale, 0, center[0] - size / 2], [0, scale, center[1] - size / 2]], np.float64
    )
    frame = (linear.shape[1], linear.shape[0])
    both = np.dstack([ball * alpha[..., None], alpha])
    # A smaller picture is averaged first: warping alone would skip pixels.
    if scale < 1:
        side = max(4, round(size))
        both = cv2.resize(both, (side, side), interpolation=cv2.INTER_AREA)
        shift[0, 0] = shift[1, 1] = size / side
    laid = cv2.warpAffine(both.astype(np.float32), shift, frame, flags=cv2.INTER_LINEAR)
    cover = np.clip(laid[..., 3:], 0, 1)
    linear *= 1 - cover
    linear += laid[..., :3]

"""What balls look like under the light of a map, and how far two such pictures are apart.

A ball of radius 1 stands at the center of the map. An orthographic camera looks at it along
-Z from +Z, with +X to the right and +Y up: light from the west (-X) lights its left side, light
from behind the camera (+Z, south) its middle, and a mirror ball shows the camera's side of the
map in its middle and the far side squeezed into its rim.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.sphere.equirect import equirect_directions
from panokit.sphere.irradiance import irradiance_map
from panokit.sphere.resample import resize_radiance
from panokit.sphere.sampling import sample
from panokit.sphere.solid_angle import row_solid_angles

# Each ball pixel is the mean of this many by this many rays.
_RAYS_PER_PIXEL = 4
_LOBE_SOURCE_WIDTH_PX = 96
_LOBE_TARGET_WIDTH_PX = 64


def diffuse_ball(radiance: NDArray[np.float32], size_px: int = 128) -> NDArray[np.float32]:
    """A white Lambertian ball: radiance E(n) / pi, without self-shadowing (a ball has none).

    Args:
        radiance: (H, W, 3) linear, equirectangular.
        size_px: Width and height of the picture; the ball fills it.

    Returns:
        (size, size, 4) float32: linear radiance in the map's unit, not multiplied by alpha,
        and alpha, the share of the pixel that the ball covers.
    """
    # Irradiance is so smooth that linear interpolation between normals 7.5 degrees apart is
    # right to 0.2 %.
    received = irradiance_map(radiance, 48) / np.float32(np.pi)
    normals = _ball_normals(size_px)
    return _picture(sample(received, normals), size_px)


def mirror_ball(radiance: NDArray[np.float32], size_px: int = 128) -> NDArray[np.float32]:
    """A perfect mirror ball; arguments and result as of `diffuse_ball`."""
    # In the ball's middle one ray's step is 2 / (rays * size) of a turn of the normal, twice
    # that of the reflection; a finer map than this would alias there.
    finest = 1 << int(np.ceil(np.log2(np.pi / 2 * size_px * _RAYS_PER_PIXEL)))
    if radiance.shape[1] > finest:
        radiance = resize_radiance(radiance, finest)
    reflected = _reflected(_ball_normals(size_px))
    return _picture(sample(np.asarray(radiance, np.float32), reflected), size_px)


def glossy_ball(
    radiance: NDArray[np.float32], size_px: int = 128, *, exponent: float = 32.0
) -> NDArray[np.float32]:
    """A rough metal ball: the light around the mirror direction, weighted by a Phong lobe.

    The lobe is (n + 1) / (2 pi) cos^n, which integrates to 1 over its hemisphere (Lafortune
    and Willems 1994, "Using the Modified Phong Reflectance Model for Physically Based
    Rendering"); with n = 32 it falls to a half at 12 degrees.

    Args:
        radiance: (H, W, 3) linear, equirectangular.
        size_px: Width and height of the picture.
        exponent: n above; at most a few hundred, since the map is first averaged to 96x48.
    """
    if not 1 <= exponent <= 300:
        raise UsageError(f"The exponent of a glossy ball is 1 to 300, not {exponent}.")
    blurred = _phong_filtered(np.asarray(radiance, np.float32), exponent)
    return _picture(sample(blurred, _reflected(_ball_normals(size_px))), size_px)


def ball_error(ball: NDArray[np.float32], reference: NDArray[np.float32]) -> float:
    """The relative RMSE between two balls as they stand.

    The root of the sum of squared differences over that of the squared reference, over all
    channels and weighted by alpha: 0 is equal, 1 is as wrong as a black ball.
    """
    values, truth = _weighted_pair(ball, reference)
    return float(np.sqrt(((values - truth) ** 2).sum() / max((truth**2).sum(), 1e-30)))


def ball_error_scale_invariant(ball: NDArray[np.float32], reference: NDArray[np.float32]) -> float:
    """`ball_error` after the one gain that makes it least (least squares): 0 is equal shading."""
    values, truth = _weighted_pair(ball, reference)
    power = float((values**2).sum())
    gain = float((values * truth).sum()) / power if power > 0 else 0.0
    return float(np.sqrt(((gain * values - truth) ** 2).sum() / max((truth**2).sum(), 1e-30)))


def _weighted_pair(
    ball: NDArray[np.float32], reference: NDArray[np.float32]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if ball.shape != reference.shape or ball.ndim != 3 or ball.shape[2] != 4:
        raise UsageError(
            f"Balls to compare have one shape (size, size, 4), not {ball.shape} and "
            f"{reference.shape}."
        )
    weight = np.sqrt(reference[..., 3:].astype(np.float64))
    return np.float64(ball[..., :3]) * weight, np.float64(reference[..., :3]) * weight


@lru_cache(maxsize=4)
def _disc(size_px: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The normal under each ray (s, s, 3), those outside pulled to the rim, and coverage."""
    if not 4 <= size_px <= 2048:
        raise UsageError(f"A ball picture is 4 to 2048 pixels wide, not {size_px}.")
    rays = size_px * _RAYS_PER_PIXEL
    across = ((np.arange(rays, dtype=np.float32) + 0.5) / rays) * 2 - 1
    x, y = np.meshgrid(across, -across)
    radius = np.hypot(x, y)
    inside = (radius < 1).astype(np.float32)
    rim = 1 / np.maximum(radius, 1)
    x, y = x * rim, y * rim
    normals = np.stack([x, y, np.sqrt(np.clip(1 - x * x - y * y, 0, 1))], axis=-1)
    normals.setflags(write=False)
    inside.setflags(write=False)
    return normals, inside


def _ball_normals(size_px: int) -> NDArray[np.float32]:
    normals, _ = _disc(size_px)
    return normals


def _reflected(normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """The direction in which each ray goes on: r = 2 (n.v) n - v, with v = +Z to the camera."""
    toward_camera = np.array([0, 0, 1], np.float32)
    return np.asarray(2 * normals[..., 2:] * normals - toward_camera, np.float32)


def _picture(rays: NDArray[np.float32], size_px: int) -> NDArray[np.float32]:
    """Rays (s, s, 3) averaged over each pixel's part of the ball, with the coverage as alpha."""
    _, disc = _disc(size_px)
    inside = disc[..., None]
    both = np.concatenate([rays * inside, inside], axis=-1)
    blocks = both.reshape(size_px, _RAYS_PER_PIXEL, size_px, _RAYS_PER_PIXEL, 4)
    mean = np.asarray(blocks.mean(axis=(1, 3)), np.float32)
    mean[..., :3] /= np.maximum(mean[..., 3:], 1e-6)
    return mean


def _phong_filtered(radiance: NDArray[np.float32], exponent: float) -> NDArray[np.float32]:
    if radiance.shape[1] > _LOBE_SOURCE_WIDTH_PX:
        radiance = resize_radiance(radiance, _LOBE_SOURCE_WIDTH_PX)
    height, width = radiance.shape[:2]
    sources = equirect_directions(width, height).reshape(-1, 3)
    solid_angles = row_solid_angles(height, width).astype(np.float32).repeat(width)
    target_height = _LOBE_TARGET_WIDTH_PX // 2
    lobes = equirect_directions(_LOBE_TARGET_WIDTH_PX, target_height).reshape(-1, 3)
    weights = np.maximum(lobes @ sources.T, 0) ** np.float32(exponent) * solid_angles
    # Dividing by the lobe's own sum keeps a uniform map uniform on this coarse grid.
    weights /= weights.sum(axis=1, keepdims=True)
    blurred = np.asarray(weights @ radiance.reshape(-1, 3), np.float32)
    return blurred.reshape(target_height, _LOBE_TARGET_WIDTH_PX, 3)

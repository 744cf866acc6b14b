"""The light that explains an object's pixels, when its normals are known: least squares.

A pixel's radiance is the light from all directions times what the surface makes of it. With the
normals known and one of a few materials assumed, that is linear in the light, and the light is
found by least squares that admit no negative light and prefer little of it. Shadows and
interreflections are left out. The material with the smallest residual is taken.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from panokit.color import srgb_decode_u8
from panokit.evaluate.lighting.baselines import ambient_map
from panokit.evaluate.lighting.sample import StereoSample
from panokit.metrics.transport.reflectance import lambertian, metal
from panokit.sphere import equirect_directions
from panokit.sphere.solid_angle import pixel_solid_angles

# Directions that light may come from: blocks of 15 degrees.
_ACROSS, _DOWN = 24, 12
_MOST_PIXELS = 500
# Light is only known up to what the surface absorbs: half of it, as most things do.
_ALBEDO = 0.5
# How much light counts against how well it explains the pixels (Tikhonov).
_PRIOR = 0.03
# Code values from here on are burnt out.
_BURNT = 250
_MATERIALS = {"matte": lambertian, "satin": metal(0.35), "glossy": metal(0.1)}


class ReflectanceInversion:
    """Non-negative least squares on the left view's pixels; knows the true normals."""

    name = "least squares (true normals)"
    digest = "least squares (true normals) 1"

    def predict(self, sample: StereoSample) -> NDArray[np.float32]:
        """(64, 64, 3)."""
        views = sample.views
        # A burnt-out pixel says "at least so bright", which least squares cannot take in.
        usable = views.mask & (np.abs(views.normals).sum(axis=-1) > 0)
        usable &= (views.left_object < _BURNT).all(axis=-1)
        rows, columns = np.nonzero(usable)
        if len(rows) < 10:
            return ambient_map(views)
        chosen = np.linspace(0, len(rows) - 1, min(_MOST_PIXELS, len(rows))).astype(int)
        normals = views.normals[rows[chosen], columns[chosen]].astype(np.float64)
        colors = srgb_decode_u8(views.left_object)[rows[chosen], columns[chosen]] / _ALBEDO
        found = [_solve(_responses(normals, name), colors) for name in _MATERIALS]
        light, _ = min(found, key=lambda pair: pair[1])
        return _as_map(light)


def _responses(normals: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    """(pixels, directions): what a unit of radiance from each direction gives in each pixel."""
    directions, solid_angles = _sky()
    toward = normals @ directions.T
    facing = np.clip(normals[:, 2:], 1e-3, 1)
    between = np.broadcast_to(directions[:, 2], toward.shape)
    return _MATERIALS[name](np.broadcast_to(facing, toward.shape), toward, between) * solid_angles


def _solve(
    responses: NDArray[np.float64], colors: NDArray[np.floating]
) -> tuple[NDArray[np.float64], float]:
    """Light (directions, 3), and what of the colors it leaves unexplained."""
    count = responses.shape[1]
    scale = max(float(colors.mean()), 1e-6)
    weight = _PRIOR * np.sqrt(len(responses)) * float(np.linalg.norm(responses, axis=0).mean())
    system = np.vstack([responses, weight / np.sqrt(len(responses)) * np.eye(count)])
    light, residual = np.empty((count, 3)), 0.0
    for channel in range(3):
        wanted = np.concatenate([colors[:, channel] / scale, np.zeros(count)])
        light[:, channel], left = nnls(system, wanted, maxiter=20 * count)
        residual += left**2
    return light * scale, residual


def _as_map(light: NDArray[np.float64]) -> NDArray[np.float32]:
    """Light in its directions as a (64, 64, 3) map, blocks smoothed at their edges."""
    coarse = light.reshape(_DOWN, _ACROSS, 3).astype(np.float32)
    rows = np.minimum(np.arange(64) * _DOWN // 64, _DOWN - 1)
    columns = np.minimum(np.arange(64) * _ACROSS // 64, _ACROSS - 1)
    return np.ascontiguousarray(coarse[rows][:, columns])


@lru_cache(maxsize=1)
def _sky() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    directions = np.asarray(equirect_directions(_ACROSS, _DOWN), np.float64).reshape(-1, 3)
    return directions, np.asarray(pixel_solid_angles(_DOWN, _ACROSS)).reshape(-1)

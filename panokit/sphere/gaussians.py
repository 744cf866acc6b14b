"""Spherical Gaussians: a map as a few smooth lobes, with the map's energy.

A lobe a exp(sharpness (axis . d - 1)) has its peak a along its axis and is about
1 / sqrt(sharpness) radians wide. Divided by its energy it is a von Mises-Fisher distribution,
so fitting lobes to a map is fitting a mixture of those to where its light comes from.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.special import softmax

from panokit.color.luminance import luminance
from panokit.equirectangular import read_only
from panokit.errors import ImageError, UsageError
from panokit.sphere.harmonics_filters import cosine_factors, vmf_factors
from panokit.sphere.irradiance import energy, irradiance, light_parcels
from panokit.sphere.lights import find_lights

# Half as wide as the sun's disk; sharper lobes could not be told apart in a map.
_SHARPEST = 2e5
_ROUNDS = 100
# Degrees of the series for a lobe's irradiance: of a point's, 0.4 % of the peak is missing.
_DEGREES = 64


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GaussianFit:
    """Lobes that stand for a map.

    Attributes:
        axes: (N, 3) float64, unit, in the map's frame.
        sharpness: (N,) float64, over 0.
        amplitudes: (N, C) float64, the peak radiance of each lobe, at least 0.
        irradiance_error: The root mean square error of the irradiance that the lobes give,
            over all normals and channels, relative to the root mean square irradiance.
    """

    axes: NDArray[np.float64]
    sharpness: NDArray[np.float64]
    amplitudes: NDArray[np.float64]
    irradiance_error: float

    @property
    def energies(self) -> NDArray[np.float64]:
        """The integral of each lobe over the sphere, (N, C): `lobe_integral` x amplitude."""
        return self.amplitudes * lobe_integral(self.sharpness)[:, None]


def lobe_integral(sharpness: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The integral of exp(sharpness (cos - 1)) over the sphere: 2 pi (1 - exp(-2 s)) / s."""
    s = np.asarray(sharpness, np.float64)
    small = s < 1e-8
    safe = np.where(small, 1.0, s)
    return np.where(small, 4 * np.pi, -2 * np.pi * np.expm1(-2 * safe) / safe)


def evaluate_gaussians(
    fit: GaussianFit, directions: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    """The radiance of the lobes together at unit directions (..., 3); (..., C) float64."""
    cosines = np.asarray(directions, np.float64) @ fit.axes.T
    return np.asarray(np.exp(fit.sharpness * (cosines - 1)) @ fit.amplitudes)


def gaussians_irradiance(
    fit: GaussianFit, normals: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    """What surfaces facing `normals` (..., 3) receive from the lobes; (..., C) float64."""
    facing = np.asarray(normals, np.float64)
    return np.asarray(_unit_irradiance(fit.axes, fit.sharpness, facing) @ fit.energies)


def fit_gaussians(radiance: NDArray[np.floating[Any]], count: int) -> GaussianFit:
    """Fit a number of lobes to a map; the same map always gives the same lobes.

    The lobes start at the map's lights, strongest first, the others spread over the sphere.
    Expectation maximization then moves them to where the light comes from (Banerjee et al.
    2005, "Clustering on the Unit Hypersphere using von Mises-Fisher Distributions"); each
    round keeps the map's energy and its light vector. Last, the amplitudes are solved for, at
    least 0, so that irradiance is right; the energy stays the map's in every channel.

    Args:
        radiance: (H, W, 3), equirectangular, at least 0, not black.
        count: How many lobes, at least 1.

    Raises:
        UsageError: If `count` is less than 1.
        ImageError: If the map is not a light map, or black.
    """
    if count < 1:
        raise UsageError(f"At least one lobe is needed, not {count}.")
    lights = find_lights(radiance, most=count - 1)
    total = energy(radiance)
    if not (total > 0).any():
        raise ImageError("A black map has no light to fit lobes to.", reason="black")
    energies, vectors = light_parcels(radiance)
    lit = luminance(energies.astype(np.float64)) > 0
    weights = np.asarray(luminance(energies[lit].astype(np.float64)), np.float64)
    # Where in each texel its light lies on the mean: shorter than 1 where it is spread out.
    moments = np.moveaxis(vectors[lit], 1, 2).astype(np.float64)
    places = np.asarray(luminance(moments) / weights[:, None], np.float64)
    axes = np.concatenate(
        [np.array([light.direction for light in lights.lights]).reshape(-1, 3), spread(count)]
    )[:count]
    sharpness = np.full(count, 2.0 * count)
    for k, light in enumerate(lights.lights):
        sharpness[k] = np.clip(2 * np.pi / light.solid_angle_sr, 1.0, _SHARPEST)
    axes, sharpness = _maximize(weights, places, axes, sharpness)
    return _with_amplitudes(radiance, axes, sharpness, total)


def spread(count: int) -> NDArray[np.float64]:
    """Directions spread evenly over the sphere, (count, 3), on Fibonacci's spiral."""
    index = np.arange(count)
    up = 1 - (2 * index + 1) / count
    azimuth = index * (np.pi * (3 - np.sqrt(5)))
    level = np.sqrt(1 - up**2)
    return np.stack([level * np.sin(azimuth), up, -level * np.cos(azimuth)], axis=1)


def _maximize(
    weights: NDArray[np.float64],
    places: NDArray[np.float64],
    axes: NDArray[np.float64],
    sharpness: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Expectation maximization of a mixture with weights (T,) at places (T, 3)."""
    shares = np.full(len(axes), 1 / len(axes))
    before = -np.inf
    for _ in range(_ROUNDS):
        # The logarithm of a lobe is linear in direction, so its mean over a texel is exact.
        logs = sharpness * (places @ axes.T - 1) + np.log(shares / lobe_integral(sharpness))
        belongs = softmax(logs, axis=1) * weights[:, None]
        held = np.maximum(belongs.sum(axis=0), 1e-300)
        resultant = belongs.T @ places
        length = np.linalg.norm(resultant, axis=1)
        axes = np.where(
            (length > 1e-12 * held)[:, None],
            resultant / np.maximum(length, 1e-300)[:, None],
            axes,
        )
        sharpness = _sharpness_of_length(length / held)
        shares = np.maximum(held / held.sum(), 1e-12)
        likelihood = float((belongs * logs).sum() / weights.sum())
        if abs(likelihood - before) < 1e-7 * abs(likelihood):
            break
        before = likelihood
    return axes, sharpness


def _sharpness_of_length(length: NDArray[np.float64]) -> NDArray[np.float64]:
    """The sharpness at which a lobe's mean direction has this length: coth s - 1 / s."""
    r = np.clip(length, 1e-6, 1 - 1 / _SHARPEST)
    # Banerjee et al. 2005, equation 4.4, then Newton's method.
    s = r * (3 - r * r) / (1 - r * r)
    for _ in range(4):
        small = s < 1e-2
        safe = np.where(small, 1.0, s)
        value = np.where(small, s / 3, 1 / np.tanh(safe) - 1 / safe)
        slope = 1 - value**2 - 2 * value / np.maximum(s, 1e-12)
        slope = np.where(small, 1 / 3, slope)
        s = np.clip(s - (value - r) / slope, 1e-6, _SHARPEST)
    return np.asarray(s)


def _with_amplitudes(
    radiance: NDArray[np.floating[Any]],
    axes: NDArray[np.float64],
    sharpness: NDArray[np.float64],
    total: NDArray[np.float64],
) -> GaussianFit:
    normals = spread(256)
    wanted = irradiance(radiance, normals)
    given = _unit_irradiance(axes, sharpness, normals)
    energies = np.zeros((len(axes), len(total)))
    for channel, whole in enumerate(total):
        if whole > 0:
            # One more equation, which outweighs the others, asks for the map's energy.
            matrix = np.vstack([given, np.full((1, len(axes)), 100.0)])
            energies[:, channel], _ = nnls(matrix, np.append(wanted[:, channel], 100.0 * whole))
            energies[:, channel] *= whole / energies[:, channel].sum()
    missed = given @ energies - wanted
    order = np.argsort(-luminance(energies), kind="stable")
    integrals = lobe_integral(sharpness)[:, None]
    return GaussianFit(
        axes=read_only(axes[order]),
        sharpness=read_only(sharpness[order]),
        amplitudes=read_only((energies / integrals)[order]),
        irradiance_error=float(np.sqrt((missed**2).mean() / (wanted**2).mean())),
    )


def _unit_irradiance(
    axes: NDArray[np.float64], sharpness: NDArray[np.float64], normals: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The irradiance that lobes of energy 1 give, (..., N), as a series in Legendre's P_l."""
    degree = np.arange(_DEGREES + 1)
    zonal = cosine_factors(_DEGREES) * (2 * degree + 1) / (4 * np.pi)
    series = np.stack([zonal * vmf_factors(float(s), _DEGREES) for s in sharpness], axis=1)
    cosines = np.clip(normals @ axes.T, -1, 1)
    value = np.polynomial.legendre.legval(cosines, series, tensor=False)
    return np.maximum(value, 0.0)

"""The same light in other forms: a lat-long map, lights, spherical Gaussians, harmonics."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.frames import azimuth_elevation_from_direction
from panokit.sphere import (
    GaussianFit,
    Light,
    LightList,
    find_lights,
    fit_gaussians,
    resize_radiance,
)

AXES = "+X right, +Y up, -Z forward; azimuth clockwise from forward, seen from above"


def latlong_radiance(radiance: NDArray[np.float32], width_px: int = 256) -> NDArray[np.float32]:
    """A square lat-long map at the usual aspect of 2:1, with the same energy.

    A lat-long map as high as wide is twice as fine in elevation as in azimuth. Each pixel becomes
    two side by side, interpolated and then scaled to the energy that it had.

    Args:
        radiance: (N, N, 3) float32.
        width_px: Even; any, smaller or larger.

    Returns:
        (width_px / 2, width_px, 3) float32.

    Raises:
        UsageError: If the map is not square, or the width is not possible.
    """
    if radiance.ndim != 3 or radiance.shape[0] != radiance.shape[1] or not radiance.size:
        raise UsageError(
            f"An anamorphic map is as high as wide, not {radiance.shape}. For others, use "
            "panokit.sphere.resize_radiance."
        )
    # Linear between the middles of pixels, at a quarter and three quarters of each.
    beside = np.stack([np.roll(radiance, 1, axis=1), np.roll(radiance, -1, axis=1)], axis=2)
    halves = 0.75 * radiance[:, :, None] + 0.25 * beside
    mean = halves.mean(axis=2)
    gain = np.divide(radiance, mean, out=np.ones_like(radiance), where=mean > 0)
    wide = (halves * gain[:, :, None]).reshape(radiance.shape[0], -1, radiance.shape[2])
    return resize_radiance(np.ascontiguousarray(wide, np.float32), width_px)


def square_radiance(radiance: NDArray[np.float32], width_px: int = 64) -> NDArray[np.float32]:
    """The way back: a lat-long map of 2:1 as a square one, energy kept."""
    return resize_radiance(radiance, width_px, width_px)


def lights_json(envmap: EnvironmentMap) -> dict[str, Any]:
    """The lights of a map, for `json.dump`: primary, secondary and all others, and the rest.

    `no_dominant_light` says that no light casts shadows that one would see; there is then no
    primary, and `why` says what the reason is. See `panokit.sphere.find_lights`.
    """
    found = find_lights(envmap.radiance)
    return {
        "schema": "panokit.lights/1",
        "axes": AXES,
        "frame": str(envmap.frame),
        "no_dominant_light": found.primary is None,
        "why": found.abstained,
        "primary": found.primary and light_json(found.primary),
        "secondary": found.secondary and light_json(found.secondary),
        "dominance": _finite(found.dominance),
        "key_to_fill": _finite(found.key_to_fill),
        "lights": [light_json(light) for light in found.lights],
        "ambient_rgb": _rounded(found.ambient),
        "ambient_share": round(_ambient_share(found), 4),
    }


def light_json(light: Light) -> dict[str, Any]:
    """One light, for `json.dump`."""
    azimuth, elevation = azimuth_elevation_from_direction(light.direction)
    return {
        "direction": [round(float(value), 6) for value in light.direction],
        "azimuth_deg": round(float(np.degrees(azimuth)), 3),
        "elevation_deg": round(float(np.degrees(elevation)), 3),
        "angular_diameter_deg": round(float(np.degrees(2 * light.angular_radius)), 3),
        "solid_angle_sr": float(f"{light.solid_angle_sr:.6g}"),
        "energy_rgb": _rounded(light.energy),
        "irradiance_rgb": _rounded(light.irradiance),
        "radiance_rgb": _rounded(light.radiance),
        "color_rgb": _rounded(light.color),
        "intensity": float(f"{light.luminance:.6g}"),
    }


def gaussians_json(envmap: EnvironmentMap, count: int) -> dict[str, Any]:
    """A map as a few lobes, for `json.dump`; a black map has none."""
    lobes: dict[str, Any] = {"axes": [], "sharpness": [], "amplitudes_rgb": []}
    error = 0.0
    if envmap.radiance.any():
        fit = fit_gaussians(envmap.radiance, count)
        error = fit.irradiance_error
        lobes = {
            "axes": [[round(float(v), 6) for v in axis] for axis in fit.axes],
            "sharpness": [float(f"{float(v):.6g}") for v in fit.sharpness],
            "amplitudes_rgb": [_rounded(row) for row in fit.amplitudes],
        }
    return {
        "schema": "panokit.gaussians/1",
        "convention": "radiance in direction d: sum of amplitude exp(sharpness (axis . d - 1))",
        "axes_of_frame": AXES,
        "frame": str(envmap.frame),
        "irradiance_error": round(error, 6),
        **lobes,
    }


def gaussians_from_json(value: dict[str, Any]) -> GaussianFit:
    """The lobes that `gaussians_json` wrote."""
    return GaussianFit(
        axes=np.array(value["axes"], np.float64).reshape(-1, 3),
        sharpness=np.array(value["sharpness"], np.float64),
        amplitudes=np.array(value["amplitudes_rgb"], np.float64).reshape(-1, 3),
        irradiance_error=float(value["irradiance_error"]),
    )


def _ambient_share(found: LightList) -> float:
    whole = float(luminance(found.energy))
    return float(luminance(4 * np.pi * found.ambient)) / whole if whole > 0 else 1.0


def _finite(value: float) -> float | None:
    """A number for JSON, which has no infinity: null where there is nothing to compare with."""
    return float(f"{value:.6g}") if np.isfinite(value) else None


def _rounded(values: NDArray[np.floating[Any]]) -> list[float]:
    return [float(f"{float(value):.6g}") for value in values]

"""What a lighting artist asks of a map, as figures for its record: lights, sun, harmonics.

The sun is told in three ways. Where the capture says when and where it was taken and the map's
north is known, it is the light within 10 degrees of where the sun then stood ("ephemeris").
Else, a model that looks for suns may have found it ("network"); where it has found none, it is
believed. Elsewhere it is a small light that dominates under a lit blue sky ("appearance"); suns
behind leaves or haze are missed that way, on purpose: a lamp taken for the sun is worse.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture, TimePrecision
from panokit.color import luminance
from panokit.frames import Frame, angle_between, azimuth_elevation_from_direction
from panokit.sphere import (
    Light,
    LightList,
    equirect_directions,
    find_lights,
    project_harmonics,
    resize_radiance,
    row_solid_angles,
)
from panokit.sun import SUN_RADIUS, sun_direction

_NEAR_SUN_DEG = 10.0
# Overhead there is a hole in a roof more often than a sun.
_LOWEST_DEG, _HIGHEST_DEG = 1.0, 80.0
_LEAST_KEY_TO_FILL = 0.5
# This share of a sun's light, glare and all, comes from so near its middle.
_CORE_DEG, _LEAST_CORE = 6.0, 0.1
# How sure a model must be that it sees the sun.
_LEAST_PROBABILITY = 0.5
_DIGITS = 6
_SKY_WIDTH_PX = 256
# Medians above the horizon: over the ground's luminance, and blue over red.
_LEAST_SKY_TO_GROUND = 0.5
_LEAST_BLUE_TO_RED = 1.2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SunHint:
    """What a model says of the sun.

    Attributes:
        direction: (3,) toward it, in the map's frame, or None where it sees none.
        looked: Whether the model looks for suns at all; one that does not says nothing.
    """

    direction: NDArray[np.float64] | None = None
    looked: bool = False


NO_HINT = SunHint()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sun:
    """The sun as an analytic light; the map holds its light, too.

    Attributes:
        direction: (3,) toward it, in the map's frame.
        irradiance: (3,) RGB that it gives to a surface that faces it, in the map's unit x sr.
        evidence: "ephemeris", "network" or "appearance", see the module.
    """

    direction: NDArray[np.float64]
    irradiance: NDArray[np.float64]
    evidence: str

    def to_json(self) -> dict[str, Any]:
        """A dictionary for the record; the radius is the true sun's, not that of its glare."""
        return {
            **_placed(self.direction),
            "angular_radius_deg": round(float(np.degrees(SUN_RADIUS)), 4),
            "irradiance_rgb": _rounded(self.irradiance),
            "evidence": self.evidence,
            "also_in_map": True,
        }


def find_sun(
    radiance: NDArray[np.float32],
    lights: LightList,
    frame: Frame,
    capture: Capture | None,
    hint: SunHint = NO_HINT,
) -> Sun | None:
    """The sun among the lights of a map, or None where there is none to be sure of.

    Args:
        radiance: (H, W, 3), linear.
        lights: Of the map.
        frame: Of the map; the sky is up only where it is level.
        capture: Of the panorama, which may know time and place.
        hint: What a model says.
    """
    known = _known_direction(frame, capture)
    if known is not None:
        return _sun_at(known, lights, "ephemeris") if known[1] > 0 else None
    hinted = None if hint.direction is None else _sun_at(hint.direction, lights, "network")
    denied = hint.looked and hint.direction is None
    if hinted is not None or denied or frame is Frame.CAMERA:
        return hinted
    light = lights.primary
    if light is None or not _looks_like_sun(light, lights):
        return None
    if not (_is_small(radiance, light) and _is_day(radiance)):
        return None
    return Sun(direction=light.direction, irradiance=light.irradiance, evidence="appearance")


def sun_hint(
    radiance: NDArray[np.float32], labels: NDArray[np.int32], probability: NDArray[np.floating]
) -> NDArray[np.float64] | None:
    """Where a model says that the sun is: the middle of a component's light, (3,), or None.

    Args:
        radiance: (H, W, 3), linear.
        labels: (H, W), k + 1 in component k.
        probability: (K,), that component k is the sun.
    """
    if not len(probability) or float(probability.max()) < _LEAST_PROBABILITY:
        return None
    inside = labels == int(np.argmax(probability)) + 1
    height, width = labels.shape
    light = luminance(radiance) * inside * row_solid_angles(height, width)[:, None]
    middle = np.tensordot(light, equirect_directions(width, height), axes=2)
    length = float(np.linalg.norm(middle))
    return np.asarray(middle / length, np.float64) if length > 0 else None


def describe_lighting(
    radiance: NDArray[np.float32],
    frame: Frame,
    capture: Capture | None,
    *,
    most_lights: int,
    harmonics_order: int,
    hint: SunHint = NO_HINT,
    range_at: Callable[[NDArray[np.float64]], tuple[float, float] | None] | None = None,
) -> Mapping[str, Any]:
    """Lights, sun and harmonics of a map, for its record.

    Args:
        radiance: (H, W, 3), linear.
        frame: Of the map.
        capture: Of the panorama, or None.
        most_lights: How many lights are listed.
        harmonics_order: Highest degree.
        hint: What a model says of the sun.
        range_at: Between which factors of its energy a light in a direction may lie, or None
            where nobody says.
    """
    lights = find_lights(radiance, most=max(most_lights, 1))
    sun = find_sun(radiance, lights, frame, capture, hint)
    primary = lights.primary
    return {
        "lights": [_light_json(light, lights, range_at) for light in lights.lights[:most_lights]],
        "ambient_rgb": _rounded(lights.ambient),
        "key_to_fill": _finite(lights.key_to_fill),
        "has_dominant_light": primary is not None,
        "sun": sun and sun.to_json(),
        "harmonics": {
            "order": harmonics_order,
            "basis": "real, orthonormal, +Y up, index l (l + 1) + m; see docs/ideas/harmonics.md",
            "rgb": [_rounded(row) for row in project_harmonics(radiance, harmonics_order)],
        },
    }


def _known_direction(frame: Frame, capture: Capture | None) -> NDArray[np.float64] | None:
    if frame is not Frame.WORLD or capture is None or capture.time is None:
        return None
    if capture.time_precision is not TimePrecision.SECOND:
        return None
    if capture.latitude_deg is None or capture.longitude_deg is None:
        return None
    return sun_direction(capture.latitude_deg, capture.longitude_deg, capture.time)


def _sun_at(direction: NDArray[np.float64], lights: LightList, evidence: str) -> Sun | None:
    near = [
        light for light in lights.lights if _degrees(light.direction, direction) < _NEAR_SUN_DEG
    ]
    if not near:
        return None
    return Sun(direction=direction, irradiance=near[0].irradiance, evidence=evidence)


def _looks_like_sun(light: Light, lights: LightList) -> bool:
    elevation = np.degrees(np.arcsin(np.clip(light.direction[1], -1, 1)))
    return bool(
        _LOWEST_DEG <= elevation <= _HIGHEST_DEG and lights.key_to_fill >= _LEAST_KEY_TO_FILL
    )


def _is_small(radiance: NDArray[np.float32], light: Light) -> bool:
    """Whether enough of a light comes from its very middle; the rest is glare or sky."""
    directions = equirect_directions(radiance.shape[1], radiance.shape[0])
    near = directions @ light.direction >= np.cos(np.deg2rad(_CORE_DEG))
    weights = near * row_solid_angles(*near.shape)[:, None]
    return bool((weights * luminance(radiance)).sum() >= _LEAST_CORE * light.luminance)


def _is_day(radiance: NDArray[np.float32]) -> bool:
    """Whether what is above the horizon is a lit blue sky, and no night, ceiling or leaves."""
    width = min(radiance.shape[1], _SKY_WIDTH_PX)
    small = resize_radiance(radiance, width)
    light = luminance(small)
    up = equirect_directions(width, width // 2)[..., 1]
    sky, ground = small[up > 0.1], light[up < -0.1]
    blue = np.median(sky[:, 2] / np.maximum(sky[:, 0], 1e-6))
    is_lit = np.median(luminance(sky)) >= _LEAST_SKY_TO_GROUND * np.median(ground)
    return bool(is_lit and blue >= _LEAST_BLUE_TO_RED)


def _light_json(
    light: Light,
    lights: LightList,
    range_at: Callable[[NDArray[np.float64]], tuple[float, float] | None] | None,
) -> dict[str, Any]:
    whole = float(luminance(lights.energy))
    between = range_at(light.direction) if range_at else None
    return {
        **_placed(light.direction),
        "angular_radius_deg": round(float(np.degrees(light.angular_radius)), 3),
        "energy_rgb": _rounded(light.energy),
        "irradiance_rgb": _rounded(light.irradiance),
        "energy_range": between and [round(factor, 3) for factor in between],
        "energy_share": round(light.luminance / max(whole, 1e-300), 4),
    }


def _placed(direction: NDArray[np.float64]) -> dict[str, Any]:
    azimuth, elevation = azimuth_elevation_from_direction(direction)
    return {
        "direction": _rounded(direction),
        "azimuth_deg": round(float(np.degrees(azimuth)), 2),
        "elevation_deg": round(float(np.degrees(elevation)), 2),
    }


def _degrees(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    return float(np.degrees(angle_between(a, b)))


def _finite(value: float) -> float | None:
    return round(value, 4) if np.isfinite(value) else None


def _rounded(values: NDArray[np.floating]) -> list[float]:
    return [float(f"{float(value):.{_DIGITS}g}") for value in values]

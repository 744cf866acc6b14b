"""The lights of a map: which sources there are, which one dominates, and what is left.

A lighting artist who looks at a probe names a few things: the sun, two windows, a lamp, and
"the rest". This finds them in that sense, or says that nothing dominates.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.equirectangular import check_equirectangular, read_only
from panokit.errors import ImageError, UsageError
from panokit.sphere.equirect import equirect_directions
from panokit.sphere.irradiance import check_radiance, energy, irradiance
from panokit.sphere.lights_regions import find_light_regions
from panokit.sphere.resample import resize_radiance
from panokit.sphere.solid_angle import row_solid_angles

# Larger maps are averaged to this width first; a sun is then still one and a half pixels wide.
_WIDEST_PX = 1024
# Nearer than this, two lights cast much the same shadow: panes of one window, lamps of a cluster.
_RIVAL_DEG = 30.0
# A light of this radius must be twice as strong as a small one to count as dominant, one of
# twice this radius three times: its shadows have no edges, so they must be deeper to be seen.
_SOFT_DEG = 4.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Light:
    """One source.

    Attributes:
        direction: (3,) float64, unit, toward the source: the middle of its energy.
        solid_angle_sr: How much of the sphere it covers, in steradians.
        energy: (3,) float64 RGB, the integral of its radiance over that.
        irradiance: (3,) float64 RGB, what it gives a surface that faces it.
    """

    direction: NDArray[np.float64]
    solid_angle_sr: float
    energy: NDArray[np.float64]
    irradiance: NDArray[np.float64]

    @property
    def angular_radius(self) -> float:
        """The radius, in radians, of a disk with this solid angle."""
        return float(np.arccos(np.clip(1 - self.solid_angle_sr / (2 * np.pi), -1, 1)))

    @property
    def radiance(self) -> NDArray[np.float64]:
        """Its mean radiance, (3,) RGB."""
        return self.energy / self.solid_angle_sr

    @property
    def luminance(self) -> float:
        """The luminance of its energy: how strong it is."""
        return float(luminance(self.energy))

    @property
    def color(self) -> NDArray[np.float64]:
        """Its color alone, (3,) linear RGB with luminance 1."""
        return self.energy / max(self.luminance, 1e-300)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LightList:
    """The light of a map, taken apart; the parts add up to the map's energy.

    Attributes:
        lights: The sources, strongest first.
        ambient: (3,) float64 RGB, all other light as a mean radiance over the whole sphere.
        key_to_fill: For the strongest light, what it gives a surface that faces it over what
            everything else gives that surface, as luminance. Over 1 its shadows are plain to
            see; under 0.1 they are hardly there. 0 if there are no lights.
        dominance: The strongest light's energy over that of its strongest rival, a light more
            than 30 degrees away from it; inf if it has none, 0 if there are no lights.
        abstained: Why there is no primary light: "no-lights", "weak" (its shadow would drown
            in the other light), "ambiguous" (a rival is as strong); "" if there is one.
        regions: (h, w) int32, read-only: k + 1 in light k, 0 elsewhere; at the size at which
            they were found.
    """

    lights: tuple[Light, ...]
    ambient: NDArray[np.float64]
    key_to_fill: float
    dominance: float
    abstained: str
    regions: NDArray[np.int32]

    @property
    def primary(self) -> Light | None:
        """The light that makes the shadows, or None where nothing dominates."""
        return self.lights[0] if self.lights and not self.abstained else None

    @property
    def secondary(self) -> Light | None:
        """The next light after the primary, if there are two and one dominates."""
        return self.lights[1] if self.primary is not None and len(self.lights) > 1 else None

    @property
    def energy(self) -> NDArray[np.float64]:
        """The energy of all parts together, (3,) RGB: the map's."""
        return 4 * np.pi * self.ambient + sum((light.energy for light in self.lights), np.zeros(3))


def find_lights(
    radiance: NDArray[np.floating[Any]],
    *,
    most: int = 12,
    least_share: float = 0.01,
    largest_sr: float = 1.0,
    least_key_to_fill: float = 0.15,
    least_dominance: float = 1.2,
) -> LightList:
    """The light sources of a map, and whether one of them dominates.

    Args:
        radiance: (H, W, 3), equirectangular, linear, at least 0.
        most: No more lights than this; the weakest go into the ambient light.
        least_share: A light gives at least this share of the map's luminance.
        largest_sr: A light covers at most this solid angle, in steradians; more is a sky.
        least_key_to_fill: A primary light with less than this over the other light is none. A
            soft one needs more, times 1 + its radius / 4 degrees: a sun is seen to cast
            shadows where a bright cloud of the same strength is not.
        least_dominance: A primary light with less than this over its rival is none.

    Raises:
        ImageError: If the map is not (H, 2 H, 3), or has negative or non-finite values.
    """
    radiance = np.asarray(radiance)
    check_equirectangular(radiance)
    check_radiance(radiance)
    if most < 0:
        raise UsageError(f"The number of lights is at least 0, not {most}.")
    radiance = radiance.astype(np.float32, copy=False)
    if not np.isfinite(radiance).all() or radiance.min() < 0:
        raise ImageError(
            "Radiance must be finite and not negative to look for lights in it. Repair the map.",
            reason="not-physical",
        )
    total = energy(radiance)
    if radiance.shape[1] > _WIDEST_PX:
        radiance = resize_radiance(radiance, _WIDEST_PX)
    found = find_light_regions(luminance(radiance), least_share=least_share, largest_sr=largest_sr)
    lights, regions = _measure(radiance, found, most)
    rest = total - sum((light.energy for light in lights), np.zeros(3))
    key_to_fill = _key_to_fill(radiance, lights[0]) if lights else 0.0
    dominance = _dominance(lights)
    if not lights:
        abstained = "no-lights"
    elif key_to_fill < least_key_to_fill * (1 + lights[0].angular_radius / np.deg2rad(_SOFT_DEG)):
        abstained = "weak"
    else:
        abstained = "ambiguous" if dominance < least_dominance else ""
    return LightList(
        lights=lights,
        ambient=np.maximum(rest, 0.0) / (4 * np.pi),
        key_to_fill=key_to_fill,
        dominance=dominance,
        abstained=abstained,
        regions=regions,
    )


def _measure(
    radiance: NDArray[np.float32], found: NDArray[np.int32], most: int
) -> tuple[tuple[Light, ...], NDArray[np.int32]]:
    """The lights in numbered regions, strongest first, and the regions numbered likewise."""
    height, width = found.shape
    count = int(found.max())
    rows, columns = np.nonzero(found)
    numbers = found[rows, columns]
    solid_angles = row_solid_angles(height, width)[rows]
    parcels = radiance[rows, columns].astype(np.float64) * solid_angles[:, None]
    directions = equirect_directions(width, height)[rows, columns].astype(np.float64)
    strength = luminance(parcels)

    def sums(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.bincount(numbers, values, count + 1)[1:], np.float64)

    energies = np.stack([sums(parcels[:, c]) for c in range(3)], axis=1)
    vectors = np.stack([sums(strength * directions[:, i]) for i in range(3)], axis=1)
    middles = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    facing = np.maximum((directions * middles[numbers - 1]).sum(axis=1), 0.0)
    received = np.stack([sums(parcels[:, c] * facing) for c in range(3)], axis=1)
    areas = sums(solid_angles)
    order = np.argsort(-luminance(energies), kind="stable")[:most]
    renumber = np.zeros(count + 1, np.int32)
    renumber[order + 1] = np.arange(1, len(order) + 1)
    lights = tuple(
        Light(
            direction=read_only(middles[k]),
            solid_angle_sr=float(areas[k]),
            energy=read_only(energies[k]),
            irradiance=read_only(received[k]),
        )
        for k in order
    )
    return lights, read_only(renumber[found])


def _key_to_fill(radiance: NDArray[np.float32], light: Light) -> float:
    everything = float(luminance(irradiance(radiance, light.direction)))
    key = float(luminance(light.irradiance))
    fill = everything - key
    return key / fill if fill > 1e-6 * key else float("inf")


def _dominance(lights: tuple[Light, ...]) -> float:
    if not lights:
        return 0.0
    nearest = np.cos(np.deg2rad(_RIVAL_DEG))
    for other in lights[1:]:
        if float(other.direction @ lights[0].direction) < nearest:
            return lights[0].luminance / other.luminance
    return float("inf")

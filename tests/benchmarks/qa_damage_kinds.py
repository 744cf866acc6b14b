"""Deliberate damage to captured probes, one function for each kind, and whom it can happen to.

Damage is drawn from a generator of its own for each map, so that a kind added later changes no
other. Where a record belongs to it, the map carries one.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from qa_damage_split import Reference

from panokit.color import luminance, srgb_encode
from panokit.envmap import EnvironmentMap
from panokit.frames import Rotation
from panokit.provenance import Provenance, Step
from panokit.sphere import (
    energy,
    equirect_directions,
    find_lights,
    resize_radiance,
    rotate_radiance,
)

Radiance = NDArray[np.float32]


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """One way to damage a map.

    Attributes:
        name: For the table.
        eligible: In words, for the table.
        applies: Whether a probe can suffer it.
        damage: What is done to the map.
        checks: Those that are meant to see it; detected is the map by whichever check fails.
    """

    name: str
    eligible: str
    applies: Callable[[Reference], bool]
    damage: Callable[[EnvironmentMap, np.random.Generator], EnvironmentMap]
    checks: Sequence[str]


def has_sun(probe: Reference) -> bool:
    return probe.is_outdoor and not probe.is_night and probe.stops >= 14


def has_horizon(probe: Reference) -> bool:
    return probe.is_outdoor


def is_daylight(probe: Reference) -> bool:
    return probe.is_outdoor and not probe.is_night


def anyone(probe: Reference) -> bool:
    return True


def _on_radiance(
    change: Callable[[Radiance, np.random.Generator], Radiance],
) -> Callable[[EnvironmentMap, np.random.Generator], EnvironmentMap]:
    def damage(envmap: EnvironmentMap, rng: np.random.Generator) -> EnvironmentMap:
        changed = np.ascontiguousarray(change(envmap.radiance, rng), np.float32)
        return envmap.with_changes(radiance=changed)

    return damage


def recorded(envmap: EnvironmentMap) -> EnvironmentMap:
    """The map with a record of its energy, as a stage would leave it."""
    values = {"energy_after": energy(envmap.radiance).tolist()}
    step = Step(stage="expand", version="1", values=values)
    return envmap.with_changes(provenance=Provenance((step,)))


def _resized_badly(interpolation: int) -> Callable[..., EnvironmentMap]:
    def damage(envmap: EnvironmentMap, rng: np.random.Generator) -> EnvironmentMap:
        size = (envmap.width_px // 8, envmap.height_px // 8)
        small = cv2.resize(envmap.radiance, size, interpolation=interpolation)
        return recorded(envmap).with_changes(radiance=np.maximum(small, 0))

    return damage


def resized_well(envmap: EnvironmentMap) -> EnvironmentMap:
    small = resize_radiance(envmap.radiance, envmap.width_px // 8)
    return recorded(envmap).with_changes(radiance=small)


def _dark_column(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    damaged = radiance.copy()
    damaged[:, 0 if rng.random() < 0.5 else -1] *= np.float32(0.8)
    return damaged


def _repeated_column(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    height, width = radiance.shape[:2]
    columns = np.arange(width) * (width / (width - 1)) - 0.5
    wrapped = np.concatenate([radiance[:, -2:], radiance, radiance[:, :2]], axis=1)
    x = np.broadcast_to(columns + 2, (height, width)).astype(np.float32)
    y = np.broadcast_to(np.arange(height)[:, None], (height, width)).astype(np.float32)
    return cv2.remap(wrapped, x, y, cv2.INTER_LINEAR)


def _second_sun(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    sun = find_lights(resize_radiance(radiance, 1024)).lights[0].direction.astype(np.float32)
    cosine = equirect_directions(radiance.shape[1], radiance.shape[0]) @ sun
    near = cosine > np.cos(np.deg2rad(3))
    around = np.median(radiance[(cosine > np.cos(np.deg2rad(5))) & ~near], axis=0)
    excess = np.where(near[..., None], np.maximum(radiance - around, 0), 0).astype(np.float32)
    turn = Rotation.about_axis((0, 1, 0), rng.uniform(0.6, 2 * np.pi - 0.6))
    return radiance + rotate_radiance(excess, turn)


def _clipped(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    return np.minimum(radiance, radiance.max() / np.float32(2 ** rng.uniform(3, 10)))


def _white_level(radiance: Radiance) -> np.float32:
    return np.float32(np.median(luminance(radiance)) / 0.2)


def _gamma_clipped(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    codes = np.rint(srgb_encode(np.clip(radiance / _white_level(radiance), 0, 1)) * 255)
    return codes.astype(np.float32) / np.float32(255)


def _gamma(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    return (radiance / _white_level(radiance)) ** np.float32(1 / 2.2)


def _upside_down(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    return radiance[::-1]


def _tilted(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    azimuth = rng.uniform(0, 2 * np.pi)
    axis = (np.cos(azimuth), 0, np.sin(azimuth))
    return rotate_radiance(radiance, Rotation.about_axis(axis, np.deg2rad(5)))


def _enlarged(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    width = radiance.shape[1]
    return resize_radiance(resize_radiance(radiance, width // 2), width)


def _enlarged_cubic(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    height, width = radiance.shape[:2]
    half = resize_radiance(radiance, width // 2)
    return np.maximum(cv2.resize(half, (width, height), interpolation=cv2.INTER_CUBIC), 0)


def _padded(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    half = resize_radiance(radiance, radiance.shape[1] // 2)
    damaged = np.zeros_like(radiance)
    damaged[: half.shape[0], : half.shape[1]] = half
    return damaged


def _swapped(radiance: Radiance, rng: np.random.Generator) -> Radiance:
    return radiance[..., ::-1]


KINDS: tuple[Kind, ...] = (
    Kind(
        name="energy lost, cv2 INTER_LINEAR to an eighth",
        eligible="all, with a record of the energy",
        applies=anyone,
        damage=_resized_badly(cv2.INTER_LINEAR),
        checks=("energy-ledger",),
    ),
    Kind(
        name="energy lost, cv2 INTER_AREA to an eighth",
        eligible="all, with a record of the energy",
        applies=anyone,
        damage=_resized_badly(cv2.INTER_AREA),
        checks=("energy-ledger",),
    ),
    Kind(
        name="energy lost, every eighth pixel",
        eligible="all, with a record of the energy",
        applies=anyone,
        damage=_resized_badly(cv2.INTER_NEAREST),
        checks=("energy-ledger",),
    ),
    Kind(
        name="seam of one pixel, a third of a stop darker",
        eligible="all",
        applies=anyone,
        damage=_on_radiance(_dark_column),
        checks=("wrap-seam",),
    ),
    Kind(
        name="seam of one pixel, the first column repeated",
        eligible="all",
        applies=anyone,
        damage=_on_radiance(_repeated_column),
        checks=("seam-repeat",),
    ),
    Kind(
        name="duplicated sun",
        eligible="outdoors by day, peak 14 stops over the median",
        applies=has_sun,
        damage=_on_radiance(_second_sun),
        checks=("twin-source",),
    ),
    Kind(
        name="clipped sun, 3 to 10 stops under its peak",
        eligible="outdoors by day, peak 14 stops over the median",
        applies=has_sun,
        damage=_on_radiance(_clipped),
        checks=("clipped-source", "clipped-area"),
    ),
    Kind(
        name="gamma left in, an 8-bit picture taken for light",
        eligible="all",
        applies=anyone,
        damage=_on_radiance(_gamma_clipped),
        checks=("contrast", "clipped-area", "dynamic-range"),
    ),
    Kind(
        name="gamma left in, unclipped values to the power 1/2.2",
        eligible="all",
        applies=anyone,
        damage=_on_radiance(_gamma),
        checks=("contrast", "dynamic-range"),
    ),
    Kind(
        name="upside down",
        eligible="outdoors",
        applies=has_horizon,
        damage=_on_radiance(_upside_down),
        checks=("uprightness",),
    ),
    Kind(
        name="tilted by 5°",
        eligible="outdoors",
        applies=has_horizon,
        damage=_on_radiance(_tilted),
        checks=("tilt",),
    ),
    Kind(
        name="half resolution, enlarged by linear interpolation",
        eligible="all",
        applies=anyone,
        damage=_on_radiance(_enlarged),
        checks=("sharpness",),
    ),
    Kind(
        name="half resolution, enlarged by cubic interpolation",
        eligible="all",
        applies=anyone,
        damage=_on_radiance(_enlarged_cubic),
        checks=("sharpness",),
    ),
    Kind(
        name="half resolution, padded with black",
        eligible="all",
        applies=anyone,
        damage=_on_radiance(_padded),
        checks=("empty-area",),
    ),
    Kind(
        name="red and blue swapped",
        eligible="outdoors by day",
        applies=is_daylight,
        damage=_on_radiance(_swapped),
        checks=("channel-order", "sky-temperature"),
    ),
)

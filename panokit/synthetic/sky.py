"""The light of the sky: where the sun stands, clear and cloudy skies, overcast, night.

Every sky is an equirectangular radiance map in the world frame without the sun, and the sun
apart: a disk with one radiance, so that its energy is exact at any resolution.
"""

import math
from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.sphere import equirect_directions

Weather = Literal["clear", "cloudy", "overcast", "night"]
Picture = NDArray[np.floating[Any]]

SKY_WIDTH_PX = 1024


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sky:
    """What lights a place from above.

    Attributes:
        radiance: (H, W, 3) float32, world frame, without the sun.
        sun_direction: (3,) unit, world frame; None where no sun shines.
        sun_radiance: (3,) of the disk; zeros where no sun shines.
    """

    radiance: Picture
    sun_direction: NDArray[np.float64] | None
    sun_radiance: NDArray[np.float64]


def overcast_sky(seed: int) -> Sky:
    """A sky closed by cloud: CIE standard overcast, L = Lz (1 + 2 sin elevation) / 3, mottled.

    CIE S 011/E:2003, sky type 1 is its refinement; the 1955 formula by Moon and Spencer is used.
    """
    directions = equirect_directions(SKY_WIDTH_PX, SKY_WIDTH_PX // 2)
    up = np.clip(directions[..., 1], 0, 1)
    mottled = 1 + 0.16 * _cloud_noise(directions, seed, 1.2)
    level = (1 + 2 * up) / 3 * np.clip(mottled, 0.5, 1.6)
    radiance = level[..., None] * np.array([0.93, 0.98, 1.06], np.float32)
    return Sky(
        radiance=_with_ground(radiance.astype(np.float32), 0.2),
        sun_direction=None,
        sun_radiance=np.zeros(3),
    )


def night_sky(seed: int) -> Sky:
    """A city's night: deep blue overhead, the glow of lamps near the horizon."""
    directions = equirect_directions(SKY_WIDTH_PX, SKY_WIDTH_PX // 2)
    up = np.clip(directions[..., 1], 0, 1)
    haze = np.exp(-up / 0.22)[..., None] * np.array([0.055, 0.034, 0.022], np.float32)
    dusk = (0.35 + 0.65 * (1 - up))[..., None] * np.array([0.010, 0.015, 0.034], np.float32)
    cloud = 1 + 0.25 * _cloud_noise(directions, seed, 1.4)
    radiance = (haze + dusk) * np.clip(cloud, 0.4, 2)[..., None]
    return Sky(
        radiance=_with_ground(radiance.astype(np.float32), 0.2),
        sun_direction=None,
        sun_radiance=np.zeros(3),
    )


def with_clouds(clear: Sky, seed: int, cover: float = 0.45) -> Sky:
    """A clear sky with heaps of cloud before it, and perhaps before the sun.

    Clouds are bright toward the sun and grey at their thick parts; their light is taken from
    the clear sky's own, so that they are as bright as such a day's clouds are.
    """
    directions = equirect_directions(SKY_WIDTH_PX, SKY_WIDTH_PX // 2)
    noise = _cloud_noise(directions, seed, 1.5)
    if clear.sun_direction is not None:
        # The sun shines through a gap; behind a cloud it would be one more overcast sky.
        away = np.arccos(np.clip(directions @ clear.sun_direction.astype(np.float32), -1, 1))
        noise = noise - 2.2 * np.exp(-((away / 0.35) ** 2))
    threshold = np.float32(np.quantile(noise[: SKY_WIDTH_PX // 4], 1 - cover))
    depth = np.maximum((noise - threshold) / 1.5, 0)
    opaque = 1 - np.exp(-7 * depth**1.5)
    mean = clear.radiance[: SKY_WIDTH_PX // 4].mean(axis=(0, 1))
    grey = float(mean.mean())
    toward = np.zeros_like(noise)
    if clear.sun_direction is not None:
        cosine = np.clip(directions @ clear.sun_direction.astype(np.float32), -1, 1)
        toward = np.exp((cosine - 1) / 0.12)
    shade = 1 - 0.5 * np.tanh(1.1 * depth) + 0.05 * _cloud_noise(directions, seed + 1, 1.1)
    lit = grey * (2.3 + 5.0 * toward) * shade
    cloud = lit[..., None] * np.array([1.0, 0.985, 0.97], np.float32)
    fade = np.clip(directions[..., 1] / 0.06, 0, 1) * opaque
    radiance = clear.radiance * (1 - fade[..., None]) + cloud * fade[..., None]
    through = 1.0
    if clear.sun_direction is not None:
        at_sun = directions @ clear.sun_direction.astype(np.float32) > math.cos(0.03)
        through = float(1 - opaque[at_sun].mean())
    return Sky(
        radiance=radiance.astype(np.float32),
        sun_direction=clear.sun_direction,
        sun_radiance=clear.sun_radiance * through,
    )


def _cloud_noise(directions: Picture, seed: int, slope: float) -> Picture:
    """Cloudy noise on a flat layer high above, as seen from below; mean 0, deviation 1."""
    size = 1024
    rng = np.random.default_rng([seed, 77])
    frequency = np.fft.fftfreq(size) * size
    distance = np.hypot(frequency[:, None], frequency[None, :])
    distance[0, 0] = 1
    # Nothing wider than a few cloud heaps, or one seed would be all cloud and another none.
    spectrum = np.fft.fft2(rng.standard_normal((size, size)))
    spectrum *= np.where(distance < 3, 0, distance**-slope)
    layer = np.fft.ifft2(spectrum).real
    layer = (layer / layer.std()).astype(np.float32)
    up = np.maximum(directions[..., 1], 0) + np.float32(0.14)
    x = np.mod(directions[..., 0] / up * (size / 9), size)
    z = np.mod(directions[..., 2] / up * (size / 9), size)
    return cv2.remap(
        layer, x.astype(np.float32), z.astype(np.float32), cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_WRAP,
    )  # fmt: skip


def _with_ground(radiance: Picture, albedo: float) -> Picture:
    """Below the horizon, the light that distant ground gives back."""
    half = radiance.shape[0] // 2
    below = radiance[half - 8 : half].mean(axis=(0, 1)) * albedo
    grounded = radiance.copy()
    grounded[half:] = below
    return grounded

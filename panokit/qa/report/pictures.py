"""What a light map looks like: exposures, tone mapping, false color, balls lit by it."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import bracket, luminance, srgb_encode_u8, tonemap, weighted_percentile
from panokit.envmap import Anchor, EnvironmentMap
from panokit.io import decode_image
from panokit.io.files import read_bytes
from panokit.metrics.balls import diffuse_ball, glossy_ball, mirror_ball
from panokit.sphere import resize_radiance, row_solid_angles

WIDE_PX = 640
BRACKET_PX = 384
BALL_PX = 144
LOWEST_STOP, HIGHEST_STOP = -6, 14
_MIDDLE_GRAY = 0.18
_BALL_WHITE = 0.8


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Exposure:
    """One picture of a bracket.

    Attributes:
        stops: Under the first picture's exposure, 0 or negative.
        pixels: (H, W, 3) uint8, sRGB-encoded.
    """

    stops: int
    pixels: NDArray[np.uint8]


@dataclass(frozen=True, slots=True, kw_only=True)
class BallExposure:
    """What linear radiance on the balls is multiplied by before it is shown."""

    diffuse: float
    specular: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Balls:
    """Balls lit by a map, as the page shows them: (size, size, 3) uint8 sRGB over middle gray.

    Attributes:
        diffuse: Exposed so that its lit side is just below white.
        glossy: Exposed like the map's pictures.
        mirror: Exposed like the map's pictures.
        exposure: The gains behind them, to expose another map's balls alike.
    """

    diffuse: NDArray[np.uint8]
    glossy: NDArray[np.uint8]
    mirror: NDArray[np.uint8]
    exposure: BallExposure


def panorama_pixels(path: Path) -> NDArray[np.uint8]:
    """A panorama's file, small."""
    pixels = decode_image(read_bytes(path), what=str(path))
    width = min(WIDE_PX, pixels.shape[1])
    return np.asarray(
        cv2.resize(pixels, (width, width // 2), interpolation=cv2.INTER_AREA), np.uint8
    )


def display_gain(envmap: EnvironmentMap) -> float:
    """What brings a map to the brightness of a photograph.

    A map anchored at the camera's white has it already. Another is exposed so that its
    median is middle gray.
    """
    if envmap.anchor is Anchor.LDR_WHITE:
        return 1.0
    median = median_luminance(envmap)
    return _MIDDLE_GRAY / median if median > 0 else 1.0


def median_luminance(envmap: EnvironmentMap) -> float:
    """The median luminance over the sphere."""
    return weighted_percentile(
        luminance(envmap.radiance), row_solid_angles(envmap.height_px)[:, None], 50
    )


def bracket_stops(peak: float) -> tuple[int, ...]:
    """Four exposures from 0 down to where a peak of this many times white is just not white.

    0, -4, -8, -12 for a bare sun; steps of one stop where there is little to see.
    """
    reach = max(0.0, float(np.log2(max(peak, 1e-12))))
    step = int(np.clip(np.ceil(reach / 3), 1, 4))
    return 0, -step, -2 * step, -3 * step


def exposures(envmap: EnvironmentMap) -> list[Exposure]:
    """The map at four exposures, chosen from its own range."""
    gain = np.float32(display_gain(envmap))
    small = _small(envmap, BRACKET_PX) * gain
    stops = bracket_stops(float(envmap.radiance.max()) * float(gain))
    return [
        Exposure(stops=ev, pixels=pixels)
        for ev, pixels in zip(stops, bracket(small, stops), strict=True)
    ]


def tonemapped(envmap: EnvironmentMap) -> NDArray[np.uint8]:
    """The map with everything in it, small."""
    return tonemap(_small(envmap, WIDE_PX))


def false_color(envmap: EnvironmentMap) -> NDArray[np.uint8]:
    """The map's luminance in stops over its median, from LOWEST_STOP to HIGHEST_STOP."""
    median = median_luminance(envmap) or 1.0
    light = luminance(_small(envmap, WIDE_PX)) / np.float32(median)
    stops = np.log2(np.maximum(light, np.float32(2.0**LOWEST_STOP)))
    return _colored((stops - LOWEST_STOP) / (HIGHEST_STOP - LOWEST_STOP))


def false_color_legend() -> NDArray[np.uint8]:
    """The colors of `false_color` from left, dark, to right, bright; (16, 512, 3)."""
    return _colored(np.linspace(0, 1, 512, dtype=np.float32)[None, :].repeat(16, 0))


def balls(envmap: EnvironmentMap, *, exposure: BallExposure | None = None) -> Balls:
    """Balls lit by a map.

    Args:
        envmap: The map.
        exposure: Of another map's balls, so that the two rows compare; else the map's own.
    """
    diffuse = diffuse_ball(envmap.radiance, BALL_PX)
    if exposure is None:
        lit = float(np.percentile(luminance(diffuse[..., :3]), 95))
        exposure = BallExposure(
            diffuse=_BALL_WHITE / max(lit, 1e-12), specular=display_gain(envmap)
        )
    return Balls(
        diffuse=_over_gray(diffuse, exposure.diffuse),
        glossy=_over_gray(glossy_ball(envmap.radiance, BALL_PX), exposure.specular),
        mirror=_over_gray(mirror_ball(envmap.radiance, BALL_PX), exposure.specular),
        exposure=exposure,
    )


def _small(envmap: EnvironmentMap, width_px: int) -> NDArray[np.float32]:
    return resize_radiance(envmap.radiance, min(width_px, envmap.width_px))


def _colored(share: NDArray[np.float32]) -> NDArray[np.uint8]:
    index = np.rint(np.clip(share, 0, 1) * 255).astype(np.uint8)
    return np.ascontiguousarray(cv2.applyColorMap(index, cv2.COLORMAP_TURBO)[..., ::-1])


def _over_gray(ball: NDArray[np.float32], gain: float) -> NDArray[np.uint8]:
    # The page cuts the picture to a disc; gray at the rim keeps JPEG from ringing there.
    alpha = ball[..., 3:]
    return srgb_encode_u8(ball[..., :3] * np.float32(gain) * alpha + _MIDDLE_GRAY * (1 - alpha))

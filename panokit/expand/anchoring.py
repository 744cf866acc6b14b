"""From relative radiance to absolute: what a user knows of the light fixes its scale."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture
from panokit.color import luminance
from panokit.envmap import Anchor
from panokit.errors import ImageError
from panokit.expand.lighting import NO_HINT, SunHint, find_sun
from panokit.expand.settings import ExpandSettings
from panokit.frames import Frame
from panokit.sphere import LightList, equirect_directions, find_lights, row_solid_angles


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """What a map is multiplied by, and what 1.0 then stands for.

    Attributes:
        factor: Over radiance in units of the clip level.
        anchor: What 1.0 is.
        by: The setting that fixed it, "" where none did.
    """

    factor: float = 1.0
    anchor: Anchor = Anchor.LDR_WHITE
    by: str = ""


def find_scale(
    radiance: NDArray[np.float32],
    settings: ExpandSettings,
    frame: Frame,
    capture: Capture | None,
    hint: SunHint = NO_HINT,
) -> Scale:
    """The scale that the settings' anchor gives to a map.

    Args:
        radiance: (H, W, 3), 1.0 is where the picture clipped.
        settings: With at most one anchor.
        frame: Of the map; sky and sun need one that is level.
        capture: Of the panorama.
        hint: What a model says of the sun.

    Raises:
        ImageError: If the map has not what the anchor speaks of.
    """
    if settings.anchor_white_cd_m2 is not None:
        return Scale(
            factor=settings.anchor_white_cd_m2, anchor=Anchor.LUMINANCE, by="anchor_white_cd_m2"
        )
    if settings.anchor_sky_cd_m2 is not None:
        factor = settings.anchor_sky_cd_m2 / sky_luminance(radiance, frame)
        return Scale(factor=factor, anchor=Anchor.LUMINANCE, by="anchor_sky_cd_m2")
    if settings.anchor_sun_lx is not None:
        factor = settings.anchor_sun_lx / _sun_light(radiance, frame, capture, hint)
        return Scale(factor=factor, anchor=Anchor.LUMINANCE, by="anchor_sun_lx")
    if settings.anchor_sun_w_m2 is not None:
        factor = settings.anchor_sun_w_m2 / _sun_light(radiance, frame, capture, hint)
        return Scale(factor=factor, anchor=Anchor.RADIANCE, by="anchor_sun_w_m2")
    return Scale()


def sky_luminance(radiance: NDArray[np.float32], frame: Frame) -> float:
    """The mean luminance above the horizon, without the lights; buildings count as sky.

    Raises:
        ImageError: If the map is not level, or black there.
    """
    _check_level(frame, "sky")
    lights = find_lights(radiance)
    height, width = lights.regions.shape
    light = luminance(radiance)
    if light.shape != (height, width):
        rows = np.arange(light.shape[0]) * height // light.shape[0]
        columns = np.arange(light.shape[1]) * width // light.shape[1]
        regions = lights.regions[rows[:, None], columns]
    else:
        regions = lights.regions
    up = equirect_directions(light.shape[1], light.shape[0])[..., 1] > 0
    weights = (up & (regions == 0)) * row_solid_angles(*light.shape)[:, None]
    mean = float((weights * light).sum() / max(float(weights.sum()), 1e-12))
    if mean <= 0:
        raise ImageError(
            "There is no light above the horizon, so the sky cannot fix the scale. Use "
            "--anchor-white-cd-m2 instead.",
            reason="no-sky",
        )
    return mean


def _sun_light(
    radiance: NDArray[np.float32],
    frame: Frame,
    capture: Capture | None,
    hint: SunHint,
) -> float:
    if hint.direction is None:
        _check_level(frame, "sun")
    lights: LightList = find_lights(radiance)
    sun = find_sun(radiance, lights, frame, capture, hint)
    if sun is None:
        raise ImageError(
            "No sun was found in this map, so its light cannot fix the scale. Use "
            "--anchor-sky-cd-m2 or --anchor-white-cd-m2 instead.",
            reason="no-sun",
        )
    return float(luminance(sun.irradiance))


def _check_level(frame: Frame, what: str) -> None:
    if frame is Frame.CAMERA:
        raise ImageError(
            f"This panorama is not level, so nobody knows where its {what} is. Level it with "
            "panokit stitch, or use --anchor-white-cd-m2.",
            reason="not-level",
        )

"""Turn a picture level and north, as far as its metadata tells."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture
from panokit.frames import Frame, Rotation
from panokit.sphere import rotate_pixels


@dataclass(frozen=True, slots=True, kw_only=True)
class Leveling:
    """How a picture is to be turned, and what that rests on.

    Attributes:
        target_from_camera: The rotation that makes the picture level.
        frame: WORLD where the heading is known, LEVEL where it is not.
        known: Which of heading, pitch and roll the metadata gave.
        assumed: Which of pitch and roll it did not give; they are taken as zero, since
            cameras for panoramas stand upright or right themselves.
    """

    target_from_camera: Rotation
    frame: Frame
    known: tuple[str, ...]
    assumed: tuple[str, ...]


def leveling_from(capture: Capture) -> Leveling:
    """What the metadata of a capture says about its pose."""
    pose = {"heading": capture.heading_deg, "pitch": capture.pitch_deg, "roll": capture.roll_deg}
    known = {name: deg for name, deg in pose.items() if deg is not None and math.isfinite(deg)}
    heading, pitch, roll = (math.radians(known.get(name, 0.0)) for name in pose)
    return Leveling(
        target_from_camera=Rotation.from_heading_pitch_roll(heading, pitch, roll),
        frame=Frame.WORLD if "heading" in known else Frame.LEVEL,
        known=tuple(known),
        assumed=tuple(name for name in ("pitch", "roll") if name not in known),
    )


def turn(
    pixels: NDArray[np.uint8], valid: NDArray[np.bool_] | None, target_from_camera: Rotation
) -> tuple[NDArray[np.uint8], NDArray[np.bool_] | None]:
    """The picture and its valid mask as they look in the target frame.

    A turn about the vertical is made by whole columns, which leaves every pixel as it was
    and is off by at most half a column, less than any compass. Everything else is
    interpolated; a pixel then is valid only if all that it is interpolated from was.

    Args:
        pixels: (H, W, 3) uint8, equirectangular.
        valid: (H, W) bool, or None if all is valid.
        target_from_camera: The rotation.
    """
    columns = whole_columns(target_from_camera, pixels.shape[1])
    if columns == 0:
        return pixels, valid
    if columns is not None:
        rolled = None if valid is None else np.roll(valid, columns, axis=1)
        return np.roll(pixels, columns, axis=1), rolled
    turned = rotate_pixels(pixels, target_from_camera)
    if valid is None:
        return turned, None
    share = rotate_pixels(valid.astype(np.uint8) * np.uint8(255), target_from_camera)
    still_valid = share == 255
    turned[~still_valid] = 0
    return turned, still_valid


def whole_columns(rotation: Rotation, width_px: int) -> int | None:
    """By how many columns the rotation moves the picture, or None if it also tilts it.

    A tilt of less than half a pixel is none.
    """
    yaw, _, _ = rotation.heading_pitch_roll()
    upright = Rotation.from_heading_pitch_roll(yaw)
    if (upright.inverse @ rotation).angle > math.pi / width_px:
        return None
    return round(yaw / (2 * math.pi) * width_px) % width_px

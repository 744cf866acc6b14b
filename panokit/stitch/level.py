"""Turn a picture level and north, as far as its metadata and its own lines tell."""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture
from panokit.frames import Frame, Rotation
from panokit.sphere import rotate_pixels
from panokit.stitch.upright import Upright, find_upright, tilt_between

# The picture overrules its metadata if it is this sure, and they differ by so much.
_SURE, _GOOD_ENOUGH, _DIFFER_DEG = 0.8, 0.5, 3.0
# Below this the picture's lines are no better than the level of a camera that rights itself.
_LEAST_TILT_DEG = 0.5

Source = Literal["metadata", "picture", "assumed"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Leveling:
    """How a picture is to be turned, and what that rests on.

    Attributes:
        target_from_camera: The rotation that makes the picture level.
        frame: WORLD where the heading is known, LEVEL where it is not.
        known: Which of heading, pitch and roll the metadata gave.
        assumed: Which of pitch and roll neither metadata nor picture gave; they are taken as
            zero, since cameras for panoramas stand upright or right themselves.
        source: What pitch and roll rest on.
        found: What the picture says, or None where it was not asked.
    """

    target_from_camera: Rotation
    frame: Frame
    known: tuple[str, ...]
    assumed: tuple[str, ...]
    source: Source = "metadata"
    found: Upright | None = None

    def to_json(self) -> dict[str, Any]:
        """JSON values for the record."""
        record: dict[str, Any] = {
            "leveled": True,
            "known": list(self.known),
            "assumed": list(self.assumed),
            "upright_from": self.source,
        }
        if self.found is not None:
            record["upright_found"] = {
                "pitch_deg": round(self.found.pitch_deg, 2),
                "roll_deg": round(self.found.roll_deg, 2),
                "confidence": self.found.confidence,
            }
        return record


def leveling_from(
    capture: Capture, pixels: NDArray[np.uint8] | None = None, upright: str = "metadata"
) -> Leveling:
    """What is known of the pose of a capture.

    Args:
        capture: Its metadata says heading, pitch and roll, or some of them.
        pixels: (H, W, 3) uint8, equirectangular, in the camera's frame; needed unless
            `upright` is "metadata".
        upright: Where pitch and roll come from: "metadata"; "picture"; or "auto", the metadata
            unless there is none, or the picture's upright lines surely contradict it.
    """
    pose = {"heading": capture.heading_deg, "pitch": capture.pitch_deg, "roll": capture.roll_deg}
    known = {name: deg for name, deg in pose.items() if deg is not None and math.isfinite(deg)}
    heading, pitch, roll = (math.radians(known.get(name, 0.0)) for name in pose)
    stated = Rotation.from_heading_pitch_roll(heading, pitch, roll)
    frame = Frame.WORLD if "heading" in known else Frame.LEVEL
    missing = tuple(name for name in ("pitch", "roll") if name not in known)
    source: Source = "assumed" if len(missing) == 2 else "metadata"
    found = None
    if upright != "metadata" and pixels is not None:
        found = find_upright(pixels)
        if _overrules(found, stated, missing, upright):
            pitch, roll = math.radians(found.pitch_deg), math.radians(found.roll_deg)
            stated = Rotation.from_heading_pitch_roll(heading, pitch, roll)
            source, missing = "picture", ()
    return Leveling(
        target_from_camera=stated,
        frame=frame,
        known=tuple(known),
        assumed=missing,
        source=source,
        found=found,
    )


def _overrules(found: Upright, stated: Rotation, missing: tuple[str, ...], upright: str) -> bool:
    """Whether pitch and roll are taken from the picture."""
    if upright == "picture":
        return found.confidence >= _GOOD_ENOUGH
    apart = tilt_between(found.level_from_camera, stated)
    if missing:
        return found.confidence >= _GOOD_ENOUGH and apart > _LEAST_TILT_DEG
    return found.confidence >= _SURE and apart > _DIFFER_DEG


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

"""Where the holes of a panorama are, each with how sure that is."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError, UsageError
from panokit.frames import Rotation
from panokit.inpaint.legs import find_legs
from panokit.inpaint.nadir import NadirCap, find_nadir_cap
from panokit.inpaint.settings import InpaintSettings
from panokit.panorama import Panorama
from panokit.sphere import equirect_directions

_DOWN = np.array([0.0, -1.0, 0.0])
# Below this difference, in radians, the points below camera and world are one.
_SAME_POINT = 0.003
_STRIP_PIXELS = 1 << 21


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hole:
    """A part of the panorama that shows nothing of the scene.

    Attributes:
        kind: "invalid", "given" or "nadir".
        mask: (H, W) bool, True in the hole.
        confidence: How sure it is that this is a hole, 0 to 1.
        details: What the finder measured, as JSON values.
    """

    kind: str
    mask: NDArray[np.bool_]
    confidence: float = 1.0
    details: Mapping[str, Any] = field(default_factory=dict)


def find_holes(
    panorama: Panorama, settings: InpaintSettings, mask: NDArray[np.bool_] | None
) -> tuple[list[Hole], dict[str, Any]]:
    """The holes to fill, and what the nadir finder said, whether that led to a hole or not.

    Pixels that are not valid always are holes. A mask of the user's stands in for the
    automatic finder; a nadir cap whose size is given is filled besides.

    Raises:
        UsageError: If the mask has not the panorama's size.
        ImageError: If nothing is left outside the holes.
    """
    holes: list[Hole] = []
    report: dict[str, Any] = {"finder": "off"}
    if panorama.valid is not None:
        holes.append(Hole(kind="invalid", mask=~panorama.valid))
    if mask is not None:
        holes.append(Hole(kind="given", mask=_checked(mask, panorama)))
    down = camera_down(panorama)
    size = (panorama.width_px, panorama.height_px)
    if isinstance(settings.nadir_deg, int | float):
        details = {"radius_deg": settings.nadir_deg}
        holes.append(
            Hole(kind="nadir", mask=cap_mask(*size, down, settings.nadir_deg), details=details)
        )
        report = {"finder": "given", **details}
    elif settings.nadir_deg == "auto" and mask is None:
        cap, center = _plainest_cap(panorama, down)
        report = {"finder": "auto", **_described(cap)}
        if cap is not None and cap.is_a_hole:
            found = cap_mask(*size, center, cap.radius_deg)
            if cap.cue == "color":
                legs, report["legs"] = find_legs(panorama.pixels, center, cap.radius_deg)
                found |= legs
            holes.append(
                Hole(kind="nadir", mask=found, confidence=cap.confidence, details=dict(report))
            )
    holes = [hole for hole in holes if hole.mask.any()]
    if holes and np.logical_or.reduce([hole.mask for hole in holes]).all():
        raise ImageError(
            f"The panorama {panorama.capture.id} is all hole: nothing is left to fill it from. "
            "Check the mask, where white marks what is to be filled.",
            reason="all-hole",
        )
    return holes, report


def camera_down(panorama: Panorama) -> NDArray[np.float64]:
    """Where the point below the camera is in the panorama: (3,), unit length.

    What the camera stands on moves with it when a picture is turned level.
    """
    step = panorama.provenance.last("stitch")
    if step is None or not step.values.get("leveled"):
        return _DOWN
    capture = panorama.capture
    pose = (capture.heading_deg or 0.0, capture.pitch_deg or 0.0, capture.roll_deg or 0.0)
    return np.asarray(Rotation.from_heading_pitch_roll(*np.deg2rad(pose)).apply(_DOWN))


def _plainest_cap(
    panorama: Panorama, down: NDArray[np.float64]
) -> tuple[NadirCap | None, NDArray[np.float64]]:
    """The cap that most directions agree on, and its center.

    A car tilts together with its camera; a tripod stays plumb below a tilted one. So in a
    picture that was turned level a cap is looked for around both points.
    """
    cap = find_nadir_cap(panorama.pixels, down)
    if np.allclose(down, _DOWN, atol=_SAME_POINT):
        return cap, down
    plumb = find_nadir_cap(panorama.pixels, _DOWN)
    if plumb is not None and (cap is None or plumb.confidence > cap.confidence):
        return plumb, _DOWN
    return cap, down


def cap_mask(
    width_px: int, height_px: int, center: NDArray[np.floating], radius_deg: float
) -> NDArray[np.bool_]:
    """The pixels within an angle of a direction, (H, W) bool."""
    mask = np.empty((height_px, width_px), np.bool_)
    least = np.cos(np.deg2rad(radius_deg))
    step = max(1, _STRIP_PIXELS // width_px)
    for top in range(0, height_px, step):
        rows = slice(top, min(top + step, height_px))
        directions = equirect_directions(width_px, height_px, rows)
        mask[rows] = directions @ np.asarray(center, np.float32) > least
    return mask


def _checked(mask: NDArray[np.bool_], panorama: Panorama) -> NDArray[np.bool_]:
    expected = (panorama.height_px, panorama.width_px)
    if mask.shape != expected or mask.dtype != np.bool_:
        raise UsageError(
            f"The mask is {mask.dtype} {mask.shape[1]}x{mask.shape[0]}; it must be bool and of "
            f"the panorama's size, {expected[1]}x{expected[0]}."
            if mask.ndim == 2
            else f"The mask has {mask.ndim} dimensions; it must be (height, width)."
        )
    return mask


def _described(cap: NadirCap | None) -> dict[str, Any]:
    if cap is None:
        return {"found": False}
    return {
        "found": True,
        "cue": cap.cue,
        "radius_deg": round(cap.radius_deg, 2),
        "confidence": round(cap.confidence, 3),
        "filled": cap.is_a_hole,
    }

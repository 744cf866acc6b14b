"""Where the holes of a panorama are, each with how sure that is."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture
from panokit.errors import ImageError, UsageError
from panokit.frames import Rotation
from panokit.inpaint.black import find_black
from panokit.inpaint.legs import find_legs
from panokit.inpaint.nadir import NadirCap, find_blurred_ground, find_nadir_cap
from panokit.inpaint.settings import InpaintSettings
from panokit.inpaint.watermark import watermark_on_tiles
from panokit.provenance import Provenance
from panokit.sphere import equirect_directions

_DOWN = np.array([0.0, -1.0, 0.0])
# Below this difference, in radians, the points below camera and world are one.
_SAME_POINT = 0.003
_STRIP_PIXELS = 1 << 21


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hole:
    """A part of the panorama that shows nothing of the scene.

    Attributes:
        kind: "invalid", "given", "black", "watermark", "nadir" or "blurred-ground".
        mask: (H, W) bool, True in the hole.
        confidence: How sure it is that this is a hole, 0 to 1.
        filled: Whether to fill it, or only to say that it is there.
        details: What the finder measured, as JSON values.
    """

    kind: str
    mask: NDArray[np.bool_]
    confidence: float = 1.0
    filled: bool = True
    details: Mapping[str, Any] = field(default_factory=dict)


def find_holes(
    pixels: NDArray[Any],
    settings: InpaintSettings,
    *,
    valid: NDArray[np.bool_] | None = None,
    mask: NDArray[np.bool_] | None = None,
    down: NDArray[np.float64] = _DOWN,
) -> tuple[list[Hole], dict[str, Any]]:
    """The holes, and what the nadir finder said, whether that led to a hole or not.

    Pixels that are not valid always are holes. A mask of the user's stands in for the
    automatic finders; a nadir cap whose size is given is filled besides.

    Args:
        pixels: (H, W, 3) uint8, equirectangular; only its size counts where no finder looks.
        settings: Which finders to ask.
        valid: (H, W) bool, False where there is nothing behind the pixel.
        mask: (H, W) bool, True where the user wants it filled.
        down: (3,), the direction below the camera; see `camera_down`.

    Raises:
        UsageError: If the mask has not the panorama's size.
        ImageError: If nothing is left outside the holes.
    """
    height, width = pixels.shape[:2]
    holes: list[Hole] = []
    report: dict[str, Any] = {"finder": "off"}
    if valid is not None:
        holes.append(Hole(kind="invalid", mask=~valid))
    if mask is not None:
        holes.append(Hole(kind="given", mask=_checked(mask, (height, width))))
    else:
        holes += _marks(pixels, settings, valid)
    if isinstance(settings.nadir_deg, int | float):
        details = {"radius_deg": settings.nadir_deg}
        cap = cap_mask(width, height, down, settings.nadir_deg)
        holes.append(Hole(kind="nadir", mask=cap, details=details))
        report = {"finder": "given", **details}
    elif settings.nadir_deg == "auto" and mask is None:
        found, report = _below(pixels, down, settings)
        holes += found
    holes = [hole for hole in holes if hole.mask.any()]
    filled = [hole.mask for hole in holes if hole.filled]
    if filled and np.logical_or.reduce(filled).all():
        raise ImageError(
            "The panorama is all hole: nothing is left to fill it from. Check the mask, where "
            "white marks what is to be filled.",
            reason="all-hole",
        )
    return holes, report


def camera_down(capture: Capture | None, provenance: Provenance) -> NDArray[np.float64]:
    """Where the point below the camera is in the panorama: (3,), unit length.

    What the camera stands on moves with it when a picture is turned level.
    """
    step = provenance.last("stitch")
    if capture is None or step is None or not step.values.get("leveled"):
        return _DOWN
    pose = (capture.heading_deg or 0.0, capture.pitch_deg or 0.0, capture.roll_deg or 0.0)
    return np.asarray(Rotation.from_heading_pitch_roll(*np.deg2rad(pose)).apply(_DOWN))


def _marks(
    pixels: NDArray[np.uint8], settings: InpaintSettings, valid: NDArray[np.bool_] | None
) -> list[Hole]:
    """What black rectangles and repeated marks there are."""
    holes = []
    if settings.fill_black:
        black, confidence = find_black(pixels, valid)
        holes.append(Hole(kind="black", mask=black, confidence=confidence))
    if settings.watermark_tile_px is not None:
        mark, confidence = watermark_on_tiles(pixels, settings.watermark_tile_px)
        holes.append(Hole(kind="watermark", mask=mark, confidence=confidence))
    return holes


def _below(
    pixels: NDArray[np.uint8], down: NDArray[np.float64], settings: InpaintSettings
) -> tuple[list[Hole], dict[str, Any]]:
    """The cap below the camera with the legs that it stands on, and ground that was blurred."""
    height, width = pixels.shape[:2]
    holes: list[Hole] = []
    blur = find_blurred_ground(pixels, down)
    if blur is not None:
        holes.append(
            Hole(
                kind="blurred-ground",
                mask=cap_mask(width, height, down, blur.radius_deg),
                confidence=blur.confidence,
                filled=settings.fill_blurred_ground,
                details=_described(blur, settings.fill_blurred_ground),
            )
        )
    cap, center = _plainest_cap(pixels, down)
    report = {"finder": "auto", **_described(cap, cap is not None and cap.is_a_hole)}
    if cap is not None and cap.is_a_hole:
        found = cap_mask(width, height, center, cap.radius_deg)
        if cap.cue == "color":
            legs, report["legs"] = find_legs(pixels, center, cap.radius_deg)
            found |= legs
        holes.append(
            Hole(kind="nadir", mask=found, confidence=cap.confidence, details=dict(report))
        )
    return holes, report


def _plainest_cap(
    pixels: NDArray[np.uint8], down: NDArray[np.float64]
) -> tuple[NadirCap | None, NDArray[np.float64]]:
    """The cap that most directions agree on, and its center.

    A car tilts together with its camera; a tripod stays plumb below a tilted one. So in a
    picture that was turned level a cap is looked for around both points.
    """
    cap = find_nadir_cap(pixels, down)
    if np.allclose(down, _DOWN, atol=_SAME_POINT):
        return cap, down
    plumb = find_nadir_cap(pixels, _DOWN)
    if plumb is not None and (cap is None or plumb.confidence > cap.confidence):
        return plumb, _DOWN
    return cap, down


def cap_mask(
    width_px: int, height_px: int, center: NDArray[np.floating], radius_deg: float
) -> NDArray[np.bool_]:
    """The pixels within an angle of a direction, (H, W) bool."""
    mask = np.zeros((height_px, width_px), np.bool_)
    least = np.cos(np.deg2rad(radius_deg))
    away = np.arccos(np.clip(-np.asarray(center)[1] / np.linalg.norm(center), -1, 1))
    # Rows farther from the pole below than the cap reaches need no look.
    highest = (np.pi - away - np.deg2rad(radius_deg)) / np.pi * height_px
    step = max(1, _STRIP_PIXELS // width_px)
    for top in range(max(0, int(highest) - 1), height_px, step):
        rows = slice(top, min(top + step, height_px))
        directions = equirect_directions(width_px, height_px, rows)
        mask[rows] = directions @ np.asarray(center, np.float32) > least
    return mask


def _checked(mask: NDArray[np.bool_], expected: tuple[int, int]) -> NDArray[np.bool_]:
    if mask.shape != expected or mask.dtype != np.bool_:
        raise UsageError(
            f"The mask is {mask.dtype} {mask.shape[1]}x{mask.shape[0]}; it must be bool and of "
            f"the panorama's size, {expected[1]}x{expected[0]}."
            if mask.ndim == 2
            else f"The mask has {mask.ndim} dimensions; it must be (height, width)."
        )
    return mask


def _described(cap: NadirCap | None, filled: bool) -> dict[str, Any]:
    if cap is None:
        return {"found": False}
    return {
        "found": True,
        "cue": cap.cue,
        "radius_deg": round(cap.radius_deg, 2),
        "confidence": round(cap.confidence, 3),
        "filled": filled,
    }

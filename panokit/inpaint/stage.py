"""The stage: a panorama or an HDR map with holes in, one without out."""

from typing import Any, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects

from panokit.envmap import EnvironmentMap
from panokit.inpaint.coding import Coding, DisplayCoding, LogCoding
from panokit.inpaint.fill import Filler, Network, fill_region, region_of
from panokit.inpaint.holes import Hole, camera_down, find_holes
from panokit.inpaint.settings import VERSION, InpaintSettings
from panokit.panorama import Panorama
from panokit.provenance import Step
from panokit.sphere import label_regions, row_solid_angles

Picture = TypeVar("Picture", Panorama, EnvironmentMap)

# Surroundings of a hole, as a share of its own size, that set the scale of an HDR filling.
_AROUND = 0.5


def inpaint(
    picture: Picture,
    settings: InpaintSettings | None = None,
    mask: NDArray[np.bool_] | None = None,
) -> Picture:
    """Fill the holes of a panorama: what is not valid, what a mask marks, what is found.

    Args:
        picture: A panorama or an environment map; one without holes comes back with its
            pixels untouched.
        settings: How; the defaults if not given.
        mask: (H, W) bool, True where to fill; it takes the place of the automatic finders.

    Returns:
        The picture, valid everywhere. Pixels outside the holes and their rims are as they
        were. Its last step says what was found, how sure that is, what was filled, where, and
        with what.

    Raises:
        UsageError: If the mask does not fit, or the network's file is not there.
        ImageError: If the picture is all hole.
        ModelError: If the network is not one for inpainting.
    """
    settings = settings or InpaintSettings()
    pixels: NDArray[Any]
    valid: NDArray[np.bool_] | None = None
    if isinstance(picture, EnvironmentMap):
        pixels = picture.radiance
        shown = _shown(picture.radiance) if _looks(settings, mask) else picture.radiance
    else:
        pixels = shown = picture.pixels
        valid = picture.valid
    holes, nadir = find_holes(
        shown,
        settings,
        valid=valid,
        mask=mask,
        down=camera_down(picture.capture, picture.provenance),
    )
    filled, fillings = _filled(pixels, [hole.mask for hole in holes if hole.filled], settings)
    area = row_solid_angles(picture.height_px, picture.width_px)
    step = Step(
        stage="inpaint",
        version=VERSION,
        settings_digest=settings.digest,
        input_digests=(picture.provenance.digest,),
        values={
            "nadir": nadir,
            "holes": [_described(hole, area) for hole in holes],
            "fillings": fillings,
        },
    )
    provenance = picture.provenance.then(step)
    if isinstance(picture, EnvironmentMap):
        return picture.with_changes(radiance=filled, provenance=provenance)
    return picture.with_changes(pixels=filled, valid=None, provenance=provenance)


def _looks(settings: InpaintSettings, mask: NDArray[np.bool_] | None) -> bool:
    """Whether any finder looks at the picture itself."""
    marks = settings.fill_black or settings.watermark_tile_px is not None
    return mask is None and (settings.nadir_deg == "auto" or marks)


def _shown(radiance: NDArray[np.float32]) -> NDArray[np.uint8]:
    """An HDR map as the finders see it: (H, W, 3) uint8."""
    below = radiance[radiance.shape[0] // 2 :]
    levels = LogCoding.around(below).encode(radiance)
    return np.clip(np.rint(levels), 0, 255).astype(np.uint8)


def _described(hole: Hole, area: NDArray[np.floating]) -> dict[str, Any]:
    return {
        "kind": hole.kind,
        "solid_angle_sr": round(float(area @ hole.mask.sum(axis=1)), 6),
        "confidence": round(hole.confidence, 3),
        "filled": hole.filled,
    }


def _filled(
    pixels: NDArray[Any], masks: list[NDArray[np.bool_]], settings: InpaintSettings
) -> tuple[NDArray[Any], list[dict[str, Any]]]:
    if not masks:
        return pixels, []
    unknown = np.logical_or.reduce(masks)
    labels, _ = label_regions(unknown)
    pixels = pixels.copy()
    filler = Filler(
        method=settings.method, rim=float(np.deg2rad(settings.rim_deg)), network=_network(settings)
    )
    fillings = []
    for label, box in enumerate(find_objects(labels), 1):
        hole = labels == label
        region = region_of(hole, filler.rim, box[0])
        coding = _coding(pixels, hole, unknown, region.rows)
        fillings.append(fill_region(pixels, hole, unknown, region, coding, filler))
        # What is filled may be copied from by the next.
        unknown &= ~hole
    return pixels, fillings


def _coding(
    pixels: NDArray[Any], hole: NDArray[np.bool_], unknown: NDArray[np.bool_], rows: slice
) -> Coding:
    """The scale for a hole: that of 8-bit pictures, or one set by what lies around the hole."""
    if pixels.dtype == np.uint8:
        return DisplayCoding()
    more = int(_AROUND * (rows.stop - rows.start))
    rows = slice(max(0, rows.start - more), rows.stop + more)
    reach = max(3, int(_AROUND * np.sqrt(hole.sum())))
    kernel = np.ones((2 * reach + 1, 1), np.uint8)
    near = cv2.dilate(cv2.dilate(hole[rows].astype(np.uint8), kernel), kernel.T) > 0
    around = near & ~unknown[rows]
    if not around.any():
        return LogCoding.around(pixels[~unknown])
    return LogCoding.around(pixels[rows][around])


def _network(settings: InpaintSettings) -> Network | None:
    if settings.network is None:
        return None
    from panokit.inpaint.network import InpaintingNetwork

    return InpaintingNetwork(settings.network)

"""The stage: a panorama with holes in, one without out."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.inpaint.fill import fill_region
from panokit.inpaint.holes import Hole, find_holes
from panokit.inpaint.settings import VERSION, InpaintSettings
from panokit.panorama import Panorama
from panokit.provenance import Step
from panokit.sphere import label_regions, row_solid_angles


def inpaint(
    panorama: Panorama,
    settings: InpaintSettings | None = None,
    mask: NDArray[np.bool_] | None = None,
) -> Panorama:
    """Fill the holes of a panorama: what is not valid, what a mask marks, the nadir cap.

    Args:
        panorama: Any; one without holes comes back with its pixels untouched.
        settings: How; the defaults if not given.
        mask: (H, W) bool, True where to fill; it takes the place of the automatic finder.

    Returns:
        A panorama that is valid everywhere. Pixels outside the holes and their rims are as
        they were. Its last step says what was filled, where, with what, and how sure it is
        that there was a hole.

    Raises:
        UsageError: If the mask does not fit.
        ImageError: If the panorama is all hole.
    """
    settings = settings or InpaintSettings()
    holes, nadir = find_holes(panorama, settings, mask)
    pixels, fillings = _filled(panorama, holes, settings)
    area = row_solid_angles(panorama.height_px, panorama.width_px)
    step = Step(
        stage="inpaint",
        version=VERSION,
        settings_digest=settings.digest,
        input_digests=(panorama.provenance.digest,),
        values={
            "nadir": nadir,
            "holes": [
                {
                    "kind": hole.kind,
                    "solid_angle_sr": round(float(area @ hole.mask.sum(axis=1)), 6),
                    "confidence": round(hole.confidence, 3),
                }
                for hole in holes
            ],
            "fillings": fillings,
        },
    )
    return panorama.with_changes(
        pixels=pixels, valid=None, provenance=panorama.provenance.then(step)
    )


def _filled(
    panorama: Panorama, holes: list[Hole], settings: InpaintSettings
) -> tuple[NDArray[np.uint8], list[dict[str, Any]]]:
    if not holes:
        return panorama.pixels, []
    unknown = np.logical_or.reduce([hole.mask for hole in holes])
    labels, count = label_regions(unknown)
    pixels = panorama.pixels.copy()
    rim = float(np.deg2rad(settings.rim_deg))
    fillings = []
    for label in range(1, count + 1):
        hole = labels == label
        fillings.append(fill_region(pixels, hole, unknown, rim, settings.method))
        # What is filled may be copied from by the next.
        unknown &= ~hole
    return pixels, fillings

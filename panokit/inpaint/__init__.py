"""Holes in a panorama found and filled: missing tiles, the tripod or car below the camera.

stage      the stage: a panorama or an HDR map with holes -> one without
holes      where the holes are, each with how sure that is
nadir      the finder of caps around the point below the camera, and of blurred ground
legs       the legs of the tripod that a cap stands on
black      the finder of tiles that never came
watermark  the finder of marks repeated in every tile or view
unroll     the picture unrolled around a point, as nadir and legs look at it
coding     the scale of gray levels on which 8-bit and HDR holes are filled alike
face       a flat view around a hole, and the way back onto the sphere
fill       which filling suits a hole; blending it in
membrane   sky: the smoothest surface through what is around
texture    ground: copies of what is around, joined where it shows least
offsets    which shifts would continue the picture into its hole
copies     what each shift would put there, and what that costs
sources    what is fit to be copied
labeling   which pixel takes which shift
adjust     the shifts at full size
seams      evening out the light between copies
opencv     OpenCV's own fillings
network    a network of the user's
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.inpaint.settings import InpaintSettings
    from panokit.inpaint.stage import inpaint
    from panokit.inpaint.watermark import find_watermark

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "InpaintSettings": "panokit.inpaint.settings",
        "find_watermark": "panokit.inpaint.watermark",
        "inpaint": "panokit.inpaint.stage",
    },
)

"""Holes in a panorama found and filled: missing tiles, the tripod or car below the camera.

stage     the stage: a panorama with holes -> one without
holes     where the holes are, each with how sure that is
nadir     the finder of caps around the point below the camera
legs      the legs of the tripod that a cap stands on
unroll    the picture unrolled around a point, as both of these look at it
face      a flat view around a hole, and the way back onto the sphere
fill      which filling suits a hole; blending it in
texture   ground: copies of what is around, joined where it shows least
membrane  sky: the smoothest surface through what is around
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.inpaint.settings import InpaintSettings
    from panokit.inpaint.stage import inpaint

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "InpaintSettings": "panokit.inpaint.settings",
        "inpaint": "panokit.inpaint.stage",
    },
)

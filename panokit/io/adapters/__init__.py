"""Maps as other tools want them, and maps of other tools as panokit's.

Pixels keep their places where a tool only calls the directions by other names; they are
resampled, with the energy kept, where its pixels lie elsewhere on the sphere. The names are
in `panokit.frames.TOOL_FROM_PANOKIT`.

skylibs  the same array
mitsuba  rows from pole to pole
openexr  the OpenEXR lat-long layout, with pixels on seam and poles; a USD dome light
blender  pixels for `image.pixels.foreach_set`
threejs  data for a `DataTexture`
"""

from panokit.io.adapters.blender import from_blender, to_blender
from panokit.io.adapters.mitsuba import from_mitsuba, mitsuba_parameter, to_mitsuba
from panokit.io.adapters.openexr import from_openexr_latlong, to_openexr_latlong, usd_dome_light
from panokit.io.adapters.skylibs import from_skylibs, to_skylibs
from panokit.io.adapters.threejs import from_threejs, to_threejs

__all__ = [
    "from_blender",
    "from_mitsuba",
    "from_openexr_latlong",
    "from_skylibs",
    "from_threejs",
    "mitsuba_parameter",
    "to_blender",
    "to_mitsuba",
    "to_openexr_latlong",
    "to_skylibs",
    "to_threejs",
    "usd_dome_light",
]

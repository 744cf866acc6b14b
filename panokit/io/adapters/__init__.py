"""Maps as other tools want them, and maps of other tools as panokit's.

Pixels keep their places where a tool only calls the directions by other names; they are
resampled, with the energy kept, where its pixels lie elsewhere on the sphere. The names are
in `panokit.frames.TOOL_FROM_PANOKIT`.

skylibs         the same array
mitsuba         rows from pole to pole
mitsuba_scene   a scene file with the environment light
openexr         the OpenEXR lat-long layout, with pixels on seam and poles
usd             a stage with a dome light
blender         pixels for `image.pixels.foreach_set`
blender_world   a script that makes a map the scene's world
threejs         data for a `DataTexture`
gltf            an image-based light in a .glb file; prefilter, its cube maps for rough surfaces
harmonics_file  spherical harmonics as JSON
analytic_sun    the sun as a light of its own, and the map without it
"""

from panokit.io.adapters.analytic_sun import AnalyticSun, sun_from_record, take_out_sun
from panokit.io.adapters.blender import from_blender, to_blender
from panokit.io.adapters.blender_world import blender_world_script
from panokit.io.adapters.gltf import gltf_environment
from panokit.io.adapters.harmonics_file import harmonics_from_json, harmonics_json
from panokit.io.adapters.mitsuba import from_mitsuba, mitsuba_parameter, to_mitsuba
from panokit.io.adapters.mitsuba_scene import mitsuba_scene
from panokit.io.adapters.openexr import from_openexr_latlong, to_openexr_latlong
from panokit.io.adapters.prefilter import prefilter_ggx
from panokit.io.adapters.skylibs import from_skylibs, to_skylibs
from panokit.io.adapters.threejs import from_threejs, to_threejs
from panokit.io.adapters.usd import usd_dome_light

__all__ = [
    "AnalyticSun",
    "blender_world_script",
    "from_blender",
    "from_mitsuba",
    "from_openexr_latlong",
    "from_skylibs",
    "from_threejs",
    "gltf_environment",
    "harmonics_from_json",
    "harmonics_json",
    "mitsuba_parameter",
    "mitsuba_scene",
    "prefilter_ggx",
    "sun_from_record",
    "take_out_sun",
    "to_blender",
    "to_mitsuba",
    "to_openexr_latlong",
    "to_skylibs",
    "to_threejs",
    "usd_dome_light",
]

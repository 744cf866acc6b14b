"""Geometry of pictures that cover the sphere, and the light in them.

equirect     pixel <-> direction, with wrap and poles
solid_angle  how much of the sphere each row of pixels covers
sampling     read a picture at any direction
resample     rotate and resize radiance without losing energy
perspective  pinhole views out of a sphere, and where a view lies on it
cubemap      six faces
irradiance   what a surface receives; the energy ledger
sources      connected bright regions, across the seam and the poles
"""

from panokit.sphere.cubemap import cubemap_directions, cubemap_faces
from panokit.sphere.equirect import equirect_directions, equirect_pixel
from panokit.sphere.irradiance import energy, irradiance, irradiance_map, light_vector
from panokit.sphere.perspective import perspective_directions, perspective_view
from panokit.sphere.resample import resize, resize_radiance, rotate, rotate_radiance
from panokit.sphere.sampling import rotate_pixels, sample
from panokit.sphere.solid_angle import pixel_solid_angles, row_solid_angles
from panokit.sphere.sources import label_regions

__all__ = [
    "cubemap_directions",
    "cubemap_faces",
    "energy",
    "equirect_directions",
    "equirect_pixel",
    "irradiance",
    "irradiance_map",
    "label_regions",
    "light_vector",
    "perspective_directions",
    "perspective_view",
    "pixel_solid_angles",
    "resize",
    "resize_radiance",
    "rotate",
    "rotate_pixels",
    "rotate_radiance",
    "row_solid_angles",
    "sample",
]

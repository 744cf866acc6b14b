"""Geometry of pictures that cover the sphere, and the light in them.

projection   what a projection is; pixels <-> directions
equirect     the sphere unrolled, also anamorphic
perspective  a pinhole camera
cubemap      six faces, in the layouts that tools use
radial       mirror ball, angular map, sky dome
octahedral   the sphere folded onto a square
projections  all of them by name
extension    borders, as the sphere goes on beyond a picture's edges
spline       the sharp filter, without rings round suns
pixel_map    where the pixels of one picture lie in another; kept for the next picture
sampling     read a picture at any direction
reproject    any projection to any other, views and faces, without aliasing
solid_angle  how much of the sphere each row of pixels covers
resample     rotate and resize radiance without losing energy
irradiance   what a surface receives; energy
energy_ledger  what a step did to the energy
sources      connected bright regions, across the seam and the poles
"""

from panokit.sphere.cubemap import Cubemap, cubemap_directions, join_faces, split_faces
from panokit.sphere.energy_ledger import EnergyLedger, energy_ledger
from panokit.sphere.equirect import Equirectangular, equirect_directions, equirect_pixel
from panokit.sphere.irradiance import energy, irradiance, irradiance_map, light_vector
from panokit.sphere.octahedral import Octahedral
from panokit.sphere.perspective import Perspective, perspective_directions
from panokit.sphere.pixel_map import PixelMap, apply_map, pixel_map
from panokit.sphere.projection import Projection, pixel_grid
from panokit.sphere.projections import PROJECTIONS
from panokit.sphere.radial import ANGULAR, MIRROR_BALL, SKY_DOME
from panokit.sphere.reproject import cubemap_faces, perspective_view, reproject
from panokit.sphere.resample import resize, resize_radiance, rotate, rotate_radiance
from panokit.sphere.sampling import rotate_pixels, sample
from panokit.sphere.solid_angle import pixel_solid_angles, row_solid_angles
from panokit.sphere.sources import label_regions

__all__ = [
    "ANGULAR",
    "MIRROR_BALL",
    "PROJECTIONS",
    "SKY_DOME",
    "Cubemap",
    "EnergyLedger",
    "Equirectangular",
    "Octahedral",
    "Perspective",
    "PixelMap",
    "Projection",
    "apply_map",
    "cubemap_directions",
    "cubemap_faces",
    "energy",
    "energy_ledger",
    "equirect_directions",
    "equirect_pixel",
    "irradiance",
    "irradiance_map",
    "join_faces",
    "label_regions",
    "light_vector",
    "perspective_directions",
    "perspective_view",
    "pixel_grid",
    "pixel_map",
    "pixel_solid_angles",
    "reproject",
    "resize",
    "resize_radiance",
    "rotate",
    "rotate_pixels",
    "rotate_radiance",
    "row_solid_angles",
    "sample",
    "split_faces",
]

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
sources      connected bright regions, across the seam and the poles; burnt-out pixels
lights       sun, windows, lamps: the lights of a map, or that none dominates
gaussians    a map as a few smooth lobes
harmonics    real spherical harmonics with +Y up; their rotation and filters
blur         the von Mises-Fisher blur
"""

from panokit.sphere.blur import blur_radiance
from panokit.sphere.cubemap import Cubemap, cubemap_directions, join_faces, split_faces
from panokit.sphere.energy_ledger import EnergyLedger, energy_ledger
from panokit.sphere.equirect import Equirectangular, equirect_directions, equirect_pixel
from panokit.sphere.gaussians import (
    GaussianFit,
    evaluate_gaussians,
    fit_gaussians,
    gaussians_irradiance,
    lobe_integral,
)
from panokit.sphere.harmonics import (
    evaluate_harmonics,
    harmonics_basis,
    harmonics_degrees,
    harmonics_map,
    harmonics_order,
    project_harmonics,
)
from panokit.sphere.harmonics_filters import (
    cosine_factors,
    irradiance_harmonics,
    nonnegative_harmonics,
    vmf_factors,
    window_harmonics,
)
from panokit.sphere.harmonics_rotation import (
    harmonics_for_tool,
    harmonics_from_tool,
    rotate_harmonics,
    rotation_matrices,
    shader_polynomial,
)
from panokit.sphere.irradiance import (
    energy,
    irradiance,
    irradiance_map,
    light_parcels,
    light_vector,
    mean_chromaticity,
)
from panokit.sphere.lights import Light, LightList, find_lights
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
from panokit.sphere.sources import label_regions, saturated_mask

__all__ = [
    "ANGULAR",
    "MIRROR_BALL",
    "PROJECTIONS",
    "SKY_DOME",
    "Cubemap",
    "EnergyLedger",
    "Equirectangular",
    "GaussianFit",
    "Light",
    "LightList",
    "Octahedral",
    "Perspective",
    "PixelMap",
    "Projection",
    "apply_map",
    "blur_radiance",
    "cosine_factors",
    "cubemap_directions",
    "cubemap_faces",
    "energy",
    "energy_ledger",
    "equirect_directions",
    "equirect_pixel",
    "evaluate_gaussians",
    "evaluate_harmonics",
    "find_lights",
    "fit_gaussians",
    "gaussians_irradiance",
    "harmonics_basis",
    "harmonics_degrees",
    "harmonics_for_tool",
    "harmonics_from_tool",
    "harmonics_map",
    "harmonics_order",
    "irradiance",
    "irradiance_harmonics",
    "irradiance_map",
    "join_faces",
    "label_regions",
    "light_parcels",
    "light_vector",
    "lobe_integral",
    "mean_chromaticity",
    "nonnegative_harmonics",
    "perspective_directions",
    "perspective_view",
    "pixel_grid",
    "pixel_map",
    "pixel_solid_angles",
    "project_harmonics",
    "reproject",
    "resize",
    "resize_radiance",
    "rotate",
    "rotate_harmonics",
    "rotate_pixels",
    "rotate_radiance",
    "rotation_matrices",
    "row_solid_angles",
    "sample",
    "saturated_mask",
    "shader_polynomial",
    "split_faces",
    "vmf_factors",
    "window_harmonics",
]

"""How good light is; each measure has a named protocol in its module.

Which figure answers which question is in docs/ideas/metrics.md; all of them by name are in
`protocols`.

differences       L1, MSE, SSD, logarithms, scale-free, color, PSNR, with solid angles
similarity        SSIM and DSSIM by presets
lighting          energy, irradiance, light vector, peak
irradiance_error  irradiance over all normals
brightest         the brightest pixel, and whether a map has a dominant light
sun_energy        the sun's strength in stops
light_blobs       the lights of a map; light_direction and light_matching compare them
envmapnet         the same extraction as published
balls             relit balls and the difference between them
transport         pictures of known scenes by precomputed transport; relit compares them
spheres           the three-sphere protocol; sphere_array, the nine-sphere one
orb, owl          scores of Stanford-ORB and of Objects With Lighting
frechet           sets of panoramas by their features
pu21              perceptual PSNR for HDR, also after tone correction
perceptual        adapters to HDR-VDP-3 and ColorVideoVDP
alignment         the one gain that relative radiance leaves open
expansion         all scores of an LDR-to-HDR expansion at once
pairs             which maps can be compared, and how much a pixel counts
statistics        from scores of scenes to a line in a table
protocols         the table of all protocols
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.metrics.alignment import alignment_gain as alignment_gain
    from panokit.metrics.balls import ball_error as ball_error
    from panokit.metrics.balls import ball_error_scale_invariant as ball_error_scale_invariant
    from panokit.metrics.balls import diffuse_ball as diffuse_ball
    from panokit.metrics.balls import glossy_ball as glossy_ball
    from panokit.metrics.balls import mirror_ball as mirror_ball
    from panokit.metrics.brightest import brightest_deg as brightest_deg
    from panokit.metrics.brightest import brightest_px as brightest_px
    from panokit.metrics.brightest import dominance_ratio as dominance_ratio
    from panokit.metrics.brightest import has_dominant_light as has_dominant_light
    from panokit.metrics.differences import l1 as l1
    from panokit.metrics.differences import log_rmse as log_rmse
    from panokit.metrics.differences import mse as mse
    from panokit.metrics.differences import psnr_db as psnr_db
    from panokit.metrics.differences import relative_l1 as relative_l1
    from panokit.metrics.differences import rgb_angular_deg as rgb_angular_deg
    from panokit.metrics.differences import rmse as rmse
    from panokit.metrics.differences import si_rmse as si_rmse
    from panokit.metrics.differences import ssd as ssd
    from panokit.metrics.envmapnet import envmapnet_lights as envmapnet_lights
    from panokit.metrics.expansion import ExpansionScore as ExpansionScore
    from panokit.metrics.expansion import score_expansion as score_expansion
    from panokit.metrics.frechet import frechet_distance as frechet_distance
    from panokit.metrics.frechet import side_faces as side_faces
    from panokit.metrics.irradiance_error import AxisErrors as AxisErrors
    from panokit.metrics.irradiance_error import irradiance_axis_errors as irradiance_axis_errors
    from panokit.metrics.irradiance_error import irradiance_sh_error as irradiance_sh_error
    from panokit.metrics.light_blobs import LightBlob as LightBlob
    from panokit.metrics.light_blobs import find_light_blobs as find_light_blobs
    from panokit.metrics.light_direction import (
        light_direction_error_deg as light_direction_error_deg,
    )
    from panokit.metrics.light_matching import LightErrors as LightErrors
    from panokit.metrics.light_matching import light_errors as light_errors
    from panokit.metrics.light_matching import match_lights as match_lights
    from panokit.metrics.lighting import beyond_clip_ratio as beyond_clip_ratio
    from panokit.metrics.lighting import energy_ratio as energy_ratio
    from panokit.metrics.lighting import irradiance_errors as irradiance_errors
    from panokit.metrics.lighting import light_vector_error_deg as light_vector_error_deg
    from panokit.metrics.lighting import peak_direction as peak_direction
    from panokit.metrics.lighting import peak_error_deg as peak_error_deg
    from panokit.metrics.orb import orb_psnr_db as orb_psnr_db
    from panokit.metrics.owl import OwlScore as OwlScore
    from panokit.metrics.owl import score_owl as score_owl
    from panokit.metrics.perceptual import AbsoluteViews as AbsoluteViews
    from panokit.metrics.perceptual import JodScore as JodScore
    from panokit.metrics.perceptual import Viewing as Viewing
    from panokit.metrics.perceptual import absolute_views as absolute_views
    from panokit.metrics.perceptual import colorvideovdp_jod as colorvideovdp_jod
    from panokit.metrics.protocols import PROTOCOLS as PROTOCOLS
    from panokit.metrics.protocols import MetricProtocol as MetricProtocol
    from panokit.metrics.protocols import native_scores as native_scores
    from panokit.metrics.protocols import protocol as protocol
    from panokit.metrics.pu21 import pu21_crf_psnr as pu21_crf_psnr
    from panokit.metrics.pu21 import pu21_encode as pu21_encode
    from panokit.metrics.pu21 import pu21_psnr as pu21_psnr
    from panokit.metrics.pu21 import pu21_psnr_y as pu21_psnr_y
    from panokit.metrics.pu21 import pu21_ssim as pu21_ssim
    from panokit.metrics.relit import relit_errors as relit_errors
    from panokit.metrics.relit import relit_three_spheres as relit_three_spheres
    from panokit.metrics.similarity import SsimSettings as SsimSettings
    from panokit.metrics.similarity import dssim as dssim
    from panokit.metrics.similarity import dssim_of_maps as dssim_of_maps
    from panokit.metrics.similarity import ssim as ssim
    from panokit.metrics.sphere_array import ArrayErrors as ArrayErrors
    from panokit.metrics.sphere_array import array_errors as array_errors
    from panokit.metrics.sphere_array import display_panel as display_panel
    from panokit.metrics.sphere_array import median_array_errors as median_array_errors
    from panokit.metrics.spheres import SphereErrors as SphereErrors
    from panokit.metrics.spheres import lighting_of_spheres as lighting_of_spheres
    from panokit.metrics.spheres import sphere_errors as sphere_errors
    from panokit.metrics.statistics import PairedDifference as PairedDifference
    from panokit.metrics.statistics import Summary as Summary
    from panokit.metrics.statistics import paired_difference as paired_difference
    from panokit.metrics.statistics import summarize as summarize
    from panokit.metrics.sun_energy import sun_energy_stops as sun_energy_stops

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "AbsoluteViews": "panokit.metrics.perceptual",
        "ArrayErrors": "panokit.metrics.sphere_array",
        "AxisErrors": "panokit.metrics.irradiance_error",
        "ExpansionScore": "panokit.metrics.expansion",
        "JodScore": "panokit.metrics.perceptual",
        "LightBlob": "panokit.metrics.light_blobs",
        "LightErrors": "panokit.metrics.light_matching",
        "MetricProtocol": "panokit.metrics.protocols",
        "OwlScore": "panokit.metrics.owl",
        "PROTOCOLS": "panokit.metrics.protocols",
        "PairedDifference": "panokit.metrics.statistics",
        "SphereErrors": "panokit.metrics.spheres",
        "SsimSettings": "panokit.metrics.similarity",
        "Summary": "panokit.metrics.statistics",
        "Viewing": "panokit.metrics.perceptual",
        "absolute_views": "panokit.metrics.perceptual",
        "alignment_gain": "panokit.metrics.alignment",
        "array_errors": "panokit.metrics.sphere_array",
        "ball_error": "panokit.metrics.balls",
        "ball_error_scale_invariant": "panokit.metrics.balls",
        "beyond_clip_ratio": "panokit.metrics.lighting",
        "brightest_deg": "panokit.metrics.brightest",
        "brightest_px": "panokit.metrics.brightest",
        "colorvideovdp_jod": "panokit.metrics.perceptual",
        "diffuse_ball": "panokit.metrics.balls",
        "display_panel": "panokit.metrics.sphere_array",
        "dominance_ratio": "panokit.metrics.brightest",
        "dssim": "panokit.metrics.similarity",
        "dssim_of_maps": "panokit.metrics.similarity",
        "energy_ratio": "panokit.metrics.lighting",
        "envmapnet_lights": "panokit.metrics.envmapnet",
        "find_light_blobs": "panokit.metrics.light_blobs",
        "frechet_distance": "panokit.metrics.frechet",
        "glossy_ball": "panokit.metrics.balls",
        "has_dominant_light": "panokit.metrics.brightest",
        "irradiance_axis_errors": "panokit.metrics.irradiance_error",
        "irradiance_errors": "panokit.metrics.lighting",
        "irradiance_sh_error": "panokit.metrics.irradiance_error",
        "l1": "panokit.metrics.differences",
        "light_direction_error_deg": "panokit.metrics.light_direction",
        "light_errors": "panokit.metrics.light_matching",
        "light_vector_error_deg": "panokit.metrics.lighting",
        "lighting_of_spheres": "panokit.metrics.spheres",
        "log_rmse": "panokit.metrics.differences",
        "match_lights": "panokit.metrics.light_matching",
        "median_array_errors": "panokit.metrics.sphere_array",
        "mirror_ball": "panokit.metrics.balls",
        "mse": "panokit.metrics.differences",
        "native_scores": "panokit.metrics.protocols",
        "orb_psnr_db": "panokit.metrics.orb",
        "paired_difference": "panokit.metrics.statistics",
        "peak_direction": "panokit.metrics.lighting",
        "peak_error_deg": "panokit.metrics.lighting",
        "protocol": "panokit.metrics.protocols",
        "psnr_db": "panokit.metrics.differences",
        "pu21_crf_psnr": "panokit.metrics.pu21",
        "pu21_encode": "panokit.metrics.pu21",
        "pu21_psnr": "panokit.metrics.pu21",
        "pu21_psnr_y": "panokit.metrics.pu21",
        "pu21_ssim": "panokit.metrics.pu21",
        "relative_l1": "panokit.metrics.differences",
        "relit_errors": "panokit.metrics.relit",
        "relit_three_spheres": "panokit.metrics.relit",
        "rgb_angular_deg": "panokit.metrics.differences",
        "rmse": "panokit.metrics.differences",
        "score_expansion": "panokit.metrics.expansion",
        "score_owl": "panokit.metrics.owl",
        "si_rmse": "panokit.metrics.differences",
        "side_faces": "panokit.metrics.frechet",
        "sphere_errors": "panokit.metrics.spheres",
        "ssd": "panokit.metrics.differences",
        "ssim": "panokit.metrics.similarity",
        "summarize": "panokit.metrics.statistics",
        "sun_energy_stops": "panokit.metrics.sun_energy",
    },
)

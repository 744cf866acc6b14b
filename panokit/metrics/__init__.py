"""How good light is; each measure has a named protocol in its module.

lighting    energy, irradiance, light vector, peak
balls       relit balls and the difference between them
pu21        perceptual PSNR for HDR, also after tone correction
alignment   the one gain that relative radiance leaves open
expansion   all scores of an LDR-to-HDR expansion at once
"""

from panokit.metrics.alignment import alignment_gain
from panokit.metrics.balls import (
    ball_error,
    ball_error_scale_invariant,
    diffuse_ball,
    glossy_ball,
    mirror_ball,
)
from panokit.metrics.expansion import ExpansionScore, score_expansion
from panokit.metrics.lighting import (
    beyond_clip_ratio,
    energy_ratio,
    irradiance_errors,
    light_vector_error_deg,
    peak_direction,
    peak_error_deg,
)
from panokit.metrics.pu21 import pu21_crf_psnr, pu21_encode, pu21_psnr

__all__ = [
    "ExpansionScore",
    "alignment_gain",
    "ball_error",
    "ball_error_scale_invariant",
    "beyond_clip_ratio",
    "diffuse_ball",
    "energy_ratio",
    "glossy_ball",
    "irradiance_errors",
    "light_vector_error_deg",
    "mirror_ball",
    "peak_direction",
    "peak_error_deg",
    "pu21_crf_psnr",
    "pu21_encode",
    "pu21_psnr",
    "score_expansion",
]

"""The scores of an LDR-to-HDR expansion against the true light.

Protocol "panokit-expansion-1": the truth is expressed in units of the level at which the
picture clipped; the estimate is brought to the truth's scale by the one gain of
`panokit.metrics.alignment`; then every score below is taken at the picture's own size, but
PU21 at no more than 512x256, averaged with the energy kept, and balls 32 pixels wide.
"""

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.metrics.alignment import alignment_gain
from panokit.metrics.balls import ball_error, ball_error_scale_invariant, diffuse_ball
from panokit.metrics.lighting import (
    beyond_clip_ratio,
    energy_ratio,
    irradiance_errors,
    light_vector_error_deg,
    peak_error_deg,
)
from panokit.metrics.pairs import check_same_shape
from panokit.metrics.pu21 import pu21_crf_psnr, pu21_psnr
from panokit.sphere import resize_radiance

PU21_WIDTH_PX = 512
BALL_PX = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpansionScore:
    """What an expansion got right.

    Attributes:
        gain: What the estimate was multiplied by to meet the truth's scale.
        energy_ratio: Luminance energy over the truth's; 1 is right.
        beyond_clip_ratio: The same over the pixels whose true luminance is beyond clipping;
            NaN if none is.
        irradiance_mean: Mean relative error of irradiance on the six axes.
        irradiance_max: The largest of the six.
        light_vector_deg: Angle between the light vectors.
        peak_deg: Angle between the brightest spots.
        ball: Relative RMSE of a diffuse ball.
        ball_scale_invariant: The same after the best gain.
        pu21_db: PU21-PSNR; never to be read alone.
        pu21_crf_db: PU21-PSNR after tone and color correction.
    """

    gain: float
    energy_ratio: float
    beyond_clip_ratio: float
    irradiance_mean: float
    irradiance_max: float
    light_vector_deg: float
    peak_deg: float
    ball: float
    ball_scale_invariant: float
    pu21_db: float
    pu21_crf_db: float

    def to_json(self) -> dict[str, float | None]:
        """A dictionary for `json.dump`; what is not finite becomes None."""
        return {name: value if np.isfinite(value) else None for name, value in asdict(self).items()}


def score_expansion(
    estimate: NDArray[np.float32], truth: NDArray[np.float32], ldr: NDArray[np.uint8]
) -> ExpansionScore:
    """Judge an expansion, see the module for the protocol.

    Args:
        estimate: (H, W, 3), linear.
        truth: (H, W, 3), linear, in units of the clip level.
        ldr: (H, W, 3), the picture that the estimate was made from.

    Raises:
        UsageError: If the sizes differ.
        ItemError: If the picture has no pixel to align by.
    """
    check_same_shape(estimate, truth)
    check_same_shape(estimate, ldr)
    gain = alignment_gain(estimate, truth, ldr)
    aligned = estimate * np.float32(gain)
    errors = irradiance_errors(aligned, truth)
    small, small_truth = _at_most(aligned, PU21_WIDTH_PX), _at_most(truth, PU21_WIDTH_PX)
    ball, true_ball = diffuse_ball(aligned, BALL_PX), diffuse_ball(truth, BALL_PX)
    return ExpansionScore(
        gain=gain,
        energy_ratio=energy_ratio(aligned, truth),
        beyond_clip_ratio=beyond_clip_ratio(aligned, truth),
        irradiance_mean=float(errors.mean()),
        irradiance_max=float(errors.max()),
        light_vector_deg=light_vector_error_deg(aligned, truth),
        peak_deg=peak_error_deg(aligned, truth),
        ball=ball_error(ball, true_ball),
        ball_scale_invariant=ball_error_scale_invariant(ball, true_ball),
        pu21_db=pu21_psnr(small, small_truth),
        pu21_crf_db=pu21_crf_psnr(small, small_truth),
    )


def _at_most(radiance: NDArray[np.float32], width_px: int) -> NDArray[np.float32]:
    wide = radiance.shape[1] > width_px
    return resize_radiance(radiance, width_px) if wide else radiance

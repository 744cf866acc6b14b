"""A map and its truth in one frame, at one size, on one scale."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance, srgb_encode_u8, weighted_percentile
from panokit.envmap import Anchor, EnvironmentMap
from panokit.errors import ItemError
from panokit.metrics.alignment import alignment_gain
from panokit.sphere import resize_radiance, row_solid_angles

# What a camera would expose to white in a map of unknown scale.
_WHITE_PERCENTILE = 95.0
_CLIPPED = np.uint8(255)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AlignedPair:
    """Two maps that can be compared pixel by pixel, in units of the camera's white.

    Attributes:
        estimate: (H, W, 3) float32, linear.
        truth: (H, W, 3) float32, linear.
        gain: What the estimate was multiplied by, because its scale is relative; 1 if not.
    """

    estimate: NDArray[np.float32]
    truth: NDArray[np.float32]
    gain: float


def align_pair(envmap: EnvironmentMap, truth: EnvironmentMap, width_px: int) -> AlignedPair:
    """Bring a map and its truth together.

    Where the scales are not one and the same absolute scale, the map is multiplied by the gain
    that fits it to the truth in the pixels that a camera would not clip. Where the camera's own
    exposure is not known, both are exposed so that 5 % of the sphere is white, and what is
    white in either counts as clipped.

    Args:
        envmap: The map.
        truth: The map it should be.
        width_px: The size to compare at; less if one of them is smaller.

    Raises:
        ItemError: If they are in different frames, or no gain can be found.
    """
    if envmap.frame is not truth.frame:
        raise ItemError(
            f"the map's frame is {envmap.frame}, the reference's is {truth.frame}. "
            "Rotate one of them first.",
            reason="other-frame",
        )
    width = min(envmap.width_px, truth.width_px, width_px)
    estimate = resize_radiance(envmap.radiance, width)
    right = resize_radiance(truth.radiance, width)
    to_white = np.float32(_exposure_to_white(estimate, envmap.anchor))
    seen = srgb_encode_u8(estimate * to_white)
    if envmap.anchor is not Anchor.LDR_WHITE:
        # A lamp that the estimate shows no brighter than a wall would decide the gain alone.
        exposed = np.float32(_exposure_to_white(right, Anchor.RELATIVE))
        seen = np.where(_is_clipped(right * exposed), _CLIPPED, seen)
    gain = 1.0 if _same_scale(envmap, truth) else _gain(estimate, right, seen)
    return AlignedPair(
        estimate=estimate * to_white, truth=right * (to_white / np.float32(gain)), gain=gain
    )


def _same_scale(envmap: EnvironmentMap, truth: EnvironmentMap) -> bool:
    absolute = (Anchor.LUMINANCE, Anchor.RADIANCE)
    return envmap.anchor is truth.anchor and envmap.anchor in absolute


def _exposure_to_white(radiance: NDArray[np.float32], anchor: Anchor) -> float:
    """What brings the map to a scale where 1 is what the camera shows as white."""
    if anchor is Anchor.LDR_WHITE:
        return 1.0
    rows = row_solid_angles(radiance.shape[0])[:, None]
    white = weighted_percentile(luminance(radiance), rows, _WHITE_PERCENTILE)
    return 1 / white if white > 0 else 1.0


def _is_clipped(exposed: NDArray[np.float32]) -> NDArray[np.bool_]:
    return np.asarray((exposed >= 1).any(axis=2, keepdims=True))


def _gain(
    estimate: NDArray[np.float32], truth: NDArray[np.float32], seen: NDArray[np.uint8]
) -> float:
    gain = alignment_gain(estimate, truth, seen)
    if gain <= 0:
        raise ItemError(
            "The reference is black where the map is not. Check that it is the right file.",
            reason="black-reference",
        )
    return gain

"""Analytic expansions: what can be had without a network.

srgb       the picture decoded; burnt-out light stays at white
reinhard   the inverse of Reinhard's tone curve (Banterle et al. 2006, "Inverse tone
           mapping", equation 8), with white standing for 16
area       every burnt-out component multiplied by exp(a + b log solid angle)
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.expand.components import Components, find_components
from panokit.expand.reduce import ReducedPanorama

REINHARD_WHITE = 16.0


@dataclass(frozen=True, slots=True, kw_only=True)
class AreaRule:
    """Log gain of a burnt-out component: `offset` + `slope` x log(its solid angle in sr)."""

    offset: float
    slope: float


# Fitted to 77 probes in many exposures; what `panokit evaluate expansion` finds for a table of
# its own is in its expansion.json.
SHIPPED_AREA_RULE = AreaRule(offset=0.8324, slope=-0.2121)


def expand_srgb(reduced: ReducedPanorama) -> NDArray[np.float32]:
    """The decoded picture as it is, (H, W, 3) float32; white is 1."""
    return reduced.linear


def expand_reinhard(reduced: ReducedPanorama) -> NDArray[np.float32]:
    """The inverse of Reinhard's curve on luminance, colors kept; (H, W, 3) float32.

    L = Lw^2 / 2 ((Ld - 1) + sqrt((1 - Ld)^2 + 4 Ld / Lw^2)), so that white becomes Lw, here
    `REINHARD_WHITE`.
    """
    display = luminance(reduced.linear)
    below = 1 - display
    root = np.sqrt(below**2 + 4 * display / REINHARD_WHITE**2)
    light = REINHARD_WHITE**2 / 2 * (root - below)
    return reduced.linear * (light / np.maximum(display, 1e-6))[..., None]


def expand_area(
    reduced: ReducedPanorama, rule: AreaRule = SHIPPED_AREA_RULE
) -> NDArray[np.float32]:
    """The saturated-area rule, (H, W, 3) float32; burnt-out light never gets darker."""
    components = find_components(reduced)
    by_label = np.concatenate([[1.0], area_gains(components, rule)]).astype(np.float32)
    return reduced.clear + reduced.burnt * by_label[components.labels][..., None]


def area_gains(components: Components, rule: AreaRule = SHIPPED_AREA_RULE) -> NDArray[np.float64]:
    """The rule's gain of each component, (K,), at least 1."""
    gains = np.exp(np.maximum(rule.offset + rule.slope * np.log(components.solid_angle), 0))
    return np.asarray(gains, np.float64)

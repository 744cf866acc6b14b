"""Published protocols on predicted maps: as published, and put right.

The scenes are panokit's own, by precomputed transport, not Blender's: figures compare the
predictors of one table with one another, and belong into no table of another renderer.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from panokit.evaluate.lighting.settings import Published
from panokit.metrics.light_direction import light_direction_error_deg
from panokit.metrics.relit import relit_three_spheres
from panokit.metrics.sphere_array import array_errors
from panokit.metrics.spheres import Variant
from panokit.metrics.transport import transport
from panokit.sphere import resize_radiance

VARIANTS: tuple[Variant, ...] = ("compat", "fixed")
SPHERES = ("mirror", "matte_silver", "diffuse")
SPHERE_PARTS = ("rmse", "si_rmse", "angular_deg", "normalized_rmse")
ARRAY_PARTS = ("rmse", "si_rmse", "angular_deg", "psnr_db")


def published_scores(
    estimate: NDArray[np.float32], truth: NDArray[np.float32], wanted: Sequence[Published]
) -> dict[str, float]:
    """The figures by name, such as "spheres-mirror-rmse-compat" or "array-si-rmse-fixed".

    Args:
        estimate: (64, 64, 3) linear radiance, anamorphic, on the scale of the truth.
        truth: As `estimate`.
        wanted: Which protocols.
    """
    guess, true = (resize_radiance(one, 64, 32) for one in (estimate, truth))
    scores: dict[str, float] = {}
    for variant in VARIANTS:
        if "spheres" in wanted:
            for ball, errors in relit_three_spheres(guess, true, variant).items():
                for part in SPHERE_PARTS:
                    scores[name_of("spheres", ball, part, variant)] = getattr(errors, part)
        if "array" in wanted:
            lit, truly = (transport("plane", 64).forward(one) for one in (guess, true))
            errors_of_array = array_errors(lit, truly, variant)
            for part in ARRAY_PARTS:
                scores[name_of("array", part, variant)] = getattr(errors_of_array, part)
        if "light-direction" in wanted:
            scores[name_of("light-direction", variant)] = light_direction_error_deg(
                guess, true, variant
            )
    return scores


def name_of(*parts: str) -> str:
    """The name of a figure."""
    return "-".join(parts).replace("_", "-")

"""All figures of one predicted map against its truth."""

import numpy as np
from numpy.typing import NDArray

from panokit.metrics.brightest import dominance_ratio
from panokit.metrics.protocols import protocol
from panokit.sphere import resize_radiance

# On the thesis's own 64x64 pictures.
ON_TARGET = (
    "thesis-mse", "thesis-ssd", "thesis-dssim", "thesis-dssim-log", "thesis-brightest-luma",
    "thesis-brightest-rgb",
)  # fmt: skip
# On the sphere: 64x32, equal energy.
ON_SPHERE = (
    "l1", "log-rmse", "si-rmse", "rgb-angular", "dssim-sphere", "irradiance-mean", "energy-ratio",
    "light-vector", "peak", "brightest", "relit-diffuse-rmse", "relit-diffuse-si-rmse",
    "relit-glossy-0.3-si-rmse", "relit-mirror-si-rmse", "relit-plane-si-rmse",
    "lights-angle-deg", "lights-missed", "lights-spurious",
)  # fmt: skip
DOMINANCE = "dominance"


def score_map(estimate: NDArray[np.float32], truth: NDArray[np.float32]) -> dict[str, float]:
    """The figures of `ON_TARGET` and `ON_SPHERE` by name, and the truth's dominance ratio.

    Args:
        estimate: (64, 64, 3) linear radiance, anamorphic, on the scale of the truth.
        truth: As `estimate`.
    """
    scores = {name: protocol(name).score(estimate, truth) for name in ON_TARGET}
    flat, true = (resize_radiance(one, 64, 32) for one in (estimate, truth))
    results: dict[tuple[str, str], object] = {}
    for name in ON_SPHERE:
        row = protocol(name)
        call = row.function, repr(row.options)
        if call not in results:
            results[call] = row.result(flat, true)
        scores[name] = row.part_of(results[call])
    scores[DOMINANCE] = dominance_ratio(true)
    return scores

"""Fitting the saturated-area rule, the analytic method that networks have to beat."""

import numpy as np
from scipy.optimize import minimize

from panokit.expand.baselines import AreaRule
from panokit.train.examples import Examples
from panokit.train.normals import NORMALS


def fit_area_rule(examples: Examples) -> AreaRule:
    """The rule's two numbers that make the least error in the light that surfaces receive.

    The error is the mean relative one of irradiance, over all pictures and 64 normals: what the
    rule is judged by, so that it is as hard to beat as it can be.
    """
    real = examples.ldr_energy > 0
    log_area = np.where(real, examples.features[..., 0], 0)
    rest = examples.rest[:, :NORMALS]
    true = rest + np.einsum("bk,bkn->bn", np.where(real, examples.energy, 0), examples.spread)

    def error(numbers: np.ndarray) -> float:
        gain = np.exp(np.clip(numbers[0] + numbers[1] * log_area, 0, 12))
        guess = rest + np.einsum("bk,bkn->bn", examples.ldr_energy * gain, examples.spread)
        return float(np.mean(np.abs(guess / true - 1)))

    start = np.array([0.7, -0.3])
    found = minimize(error, start, method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-5})
    offset, slope = found.x
    return AreaRule(offset=round(float(offset), 4), slope=round(float(slope), 4))

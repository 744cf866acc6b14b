"""Fitting the saturated-area rule, the analytic method that networks have to beat."""

import numpy as np

from panokit.expand.baselines import AreaRule
from panokit.train.examples import Examples


def fit_area_rule(examples: Examples) -> AreaRule:
    """The rule's two numbers by least squares on the logs of the gains.

    Every picture weighs the same; within it each component weighs as much as its share of
    the burnt-out light that the picture should have shown.
    """
    real = examples.ldr_energy > 0
    light = np.where(real, examples.energy, 0)
    weight = light / np.maximum(light.sum(axis=1, keepdims=True), 1e-9)
    log_area = examples.features[..., 0][real]
    log_gain = np.log(np.maximum(examples.energy[real] / examples.ldr_energy[real], 1))
    root = np.sqrt(weight[real])
    design = np.stack([np.ones_like(log_area), log_area], axis=1) * root[:, None]
    (offset, slope), *_ = np.linalg.lstsq(design, log_gain * root, rcond=None)
    return AreaRule(offset=round(float(offset), 4), slope=round(float(slope), 4))

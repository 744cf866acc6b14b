"""The error of the directions of a map's lights, after EnvMapNet.

Somanath and Kurz 2021, section 4.2: for up to five lights of each map, the mean angle from each
light of one map to the nearest of the other, both ways.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import angle_between
from panokit.metrics.envmapnet import envmapnet_lights
from panokit.metrics.light_blobs import find_light_blobs
from panokit.metrics.pairs import Radiance, radiance_pair

Variant = Literal["compat", "fixed"]

MOST_LIGHTS = 5


def light_direction_error_deg(
    estimate: Radiance, truth: Radiance, variant: Variant = "fixed"
) -> float:
    """The mean angle between the lights of two maps, in degrees.

    Nearest neighbors may be shared, and a light that was missed costs the angle to some other
    one, however faint: the figure mixes directions with misses.
    `panokit.metrics.light_matching` tells them apart.

    "compat" gives what the published code prints, by the lights of `panokit.metrics.envmapnet`:
    both lists are cut to the length of the shorter one, in scan order, so with one light in the
    truth and three in the estimate it is chance which of the three is looked at. A single light
    is doubled first, as DiffusionLight's version of the code does; so two of the other map's
    lights are then looked at.

    "fixed" compares the five strongest of each by `panokit.metrics.light_blobs`, all with all.

    Args:
        estimate: (H, W, 3), linear; the scale does not matter.
        truth: (H, W, 3), linear, in the same frame.
        variant: See above.

    Returns:
        Degrees; NaN where a map has no light. The published code says -1 there, and its
        evaluation leaves the pair out, as `panokit.metrics.statistics` does with NaN.

    Raises:
        UsageError: If the variant is not known, or the shapes differ.
    """
    radiance_pair(estimate, truth)
    if variant == "compat":
        guess, true = envmapnet_lights(estimate), envmapnet_lights(truth)
        guess, true = (np.concatenate([d, d]) if len(d) == 1 else d for d in (guess, true))
        shared = min(MOST_LIGHTS, len(guess), len(true))
        return nearest_angle_deg(guess[:shared], true[:shared])
    if variant == "fixed":
        guess, true = (
            np.array([blob.direction for blob in find_light_blobs(m)[:MOST_LIGHTS]]).reshape(-1, 3)
            for m in (estimate, truth)
        )
        return nearest_angle_deg(guess, true)
    raise UsageError(f"The variant is 'compat' or 'fixed', not {variant!r}.")


def nearest_angle_deg(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """The mean over all of (n, 3) and (m, 3) of the angle to the nearest of the other.

    The published 2 asin(|a - b| / 2) of unit vectors is the same angle. NaN if one is empty.
    """
    if not len(a) or not len(b):
        return float("nan")
    angles = np.degrees(angle_between(a[:, None], b[None]))
    nearest = np.concatenate([angles.min(axis=1), angles.min(axis=0)])
    return float(nearest.mean())

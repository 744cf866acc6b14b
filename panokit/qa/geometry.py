"""Figures about the two places where an equirectangular picture is cut: the seam and the poles.

Both compare the step across the cut with the steps beside it, in log luminance, so that neither
a bright nor a busy picture counts as broken. On a whole map the ratio is about 1.
"""

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.envmap import EnvironmentMap
from panokit.sphere import row_solid_angles

_NEIGHBORS = 8
# Darker than this under the median is noise; and steps below this many stops cannot be seen.
_FLOOR_STOPS = -8.0
_LEAST_STEP_STOPS = 0.01


def seam_step(envmap: EnvironmentMap) -> float:
    """The step between the last column and the first, over the median step beside it.

    Takes the worst of the three steps that touch the first or the last column, so that one
    bad column is seen as well as a jump.
    """
    stops = _stops(envmap)
    weights = row_solid_angles(envmap.height_px)
    reach = min(_NEIGHBORS, envmap.width_px // 4) + 1
    near = np.concatenate([stops[:, -reach - 1 :], stops[:, : reach + 1]], axis=1)
    # The mean of roots, squared: a seam runs through most rows, while a lamp or a door frame
    # that happens to stand there makes big steps in a few.
    roots = np.sqrt(np.abs(np.diff(near, axis=1)))
    typical_steps = ((roots * weights[:, None]).sum(axis=0) / weights.sum()) ** 2
    middle = len(typical_steps) // 2
    touching = typical_steps[middle - 1 : middle + 2]
    beside = np.concatenate([typical_steps[: middle - 1], typical_steps[middle + 2 :]])
    return float(touching.max() / max(float(np.median(beside)), _LEAST_STEP_STOPS))


def pole_step(envmap: EnvironmentMap) -> float:
    """The step across the worse pole, over the median step between the rows next to it.

    Pixels of the outermost row that lie opposite each other are one pixel apart on the
    sphere, like neighbors in a column. A picture that was painted flat, without regard to
    the pole, has a pinwheel there.
    """
    stops = _stops(envmap)
    return max(_pole_step(stops), _pole_step(stops[::-1]))


def _pole_step(stops: NDArray[np.float32]) -> float:
    across = np.abs(stops[0] - np.roll(stops[0], stops.shape[1] // 2)).mean()
    reach = min(_NEIGHBORS, stops.shape[0] // 4)
    down = np.abs(np.diff(stops[1 : reach + 2], axis=0)).mean(axis=1)
    return float(across / max(float(np.median(down)), _LEAST_STEP_STOPS))


def _stops(envmap: EnvironmentMap) -> NDArray[np.float32]:
    """Luminance in stops over its median, floored."""
    light = luminance(envmap.radiance)
    median = float(np.median(light)) or float(light.mean()) or 1.0
    # A difference of logarithms, where a quotient would overflow at the ends of float32.
    floor = max(median * 2.0**_FLOOR_STOPS, float(np.finfo(np.float32).tiny))
    stops = np.log2(np.maximum(light, np.float32(floor))) - np.log2(median)
    return np.asarray(stops, np.float32)

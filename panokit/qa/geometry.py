"""Figures about the two places where an equirectangular picture is cut: the seam and the poles.

Both compare the cut with what lies beside it, in log luminance, so that neither a bright nor a
busy picture counts as broken.
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
# The rows around a pole to compare it with; what counts as fine; and what cannot be seen.
_RING_ROWS = (12, 25)
# Below 256x128 noise looks like a pinwheel: the ring has too few pixels to tell.
_LEAST_HEIGHT_PX = 128
_COARSE_WAVES = 12
_LEAST_DETAIL_STOPS = 0.1


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


def pole_detail(envmap: EnvironmentMap) -> float | None:
    """How much of the fine detail around the worse pole is still there at the pole itself.

    The outermost row of pixels is a ring hardly wider than a pixel: the world can show an
    edge in it, but no fine detail along it. A picture that was painted flat, without regard
    to the pole, carries the detail of the rows around it right into the pole, as a pinwheel.
    0 is the world, 1 a pinwheel; None for a map too small to have detail there.
    """
    if envmap.height_px < _LEAST_HEIGHT_PX:
        return None
    stops = _stops(envmap)
    return max(_pole_detail(stops), _pole_detail(stops[::-1]))


def _pole_detail(stops: NDArray[np.float32]) -> float:
    around = _fine_detail(stops[slice(*_RING_ROWS)]).mean()
    return float(_fine_detail(stops[:1]).mean() / max(float(around), _LEAST_DETAIL_STOPS))


def _fine_detail(rows: NDArray[np.float32]) -> NDArray[np.floating]:
    """The size of what changes more than a dozen times along each row, in stops."""
    waves = np.fft.rfft(rows, axis=1)
    waves[:, : _COARSE_WAVES + 1] = 0
    return np.asarray(np.abs(np.fft.irfft(waves, rows.shape[1], axis=1)))


def _stops(envmap: EnvironmentMap) -> NDArray[np.float32]:
    """Luminance in stops over its median, floored."""
    light = luminance(envmap.radiance)
    median = float(np.median(light)) or float(light.mean()) or 1.0
    # A difference of logarithms, where a quotient would overflow at the ends of float32.
    floor = max(median * 2.0**_FLOOR_STOPS, float(np.finfo(np.float32).tiny))
    stops = np.log2(np.maximum(light, np.float32(floor))) - np.log2(median)
    return np.asarray(stops, np.float32)

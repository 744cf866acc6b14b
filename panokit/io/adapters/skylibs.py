"""skylibs: the same pixels, rows and axes; only the type differs."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.frames import Frame


def to_skylibs(envmap: EnvironmentMap) -> NDArray[np.float32]:
    """The array for `EnvironmentMap(array, "latlong")` of skylibs, (H, W, 3), yours to change."""
    return np.array(envmap.radiance)


def from_skylibs(data: NDArray[np.floating[Any]], *, frame: Frame = Frame.LEVEL) -> EnvironmentMap:
    """A map from the `data` of a skylibs map in the format "latlong".

    Raises:
        ImageError: If it is not (H, 2 H, 3), or not physical.
    """
    return EnvironmentMap(radiance=np.array(data, np.float32), frame=frame)

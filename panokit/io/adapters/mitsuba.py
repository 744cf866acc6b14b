"""Mitsuba 3: rows from pole to pole, and two columns more inside a loaded scene.

Its `envmap` puts the first row of the bitmap on the zenith and the last on the nadir, while
its columns have their centers half a pixel inside, like panokit's. +Y is up and the center
looks along +Z: with d of panokit, (-x, y, -z).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError
from panokit.frames import Frame
from panokit.io.adapters.nodes import rows_as_cells, rows_from_pole_to_pole


def to_mitsuba(envmap: EnvironmentMap) -> NDArray[np.float32]:
    """The array for `mi.Bitmap(array)` of an `envmap` emitter, (H, W, 3) float32.

    Resampled to Mitsuba's rows with the energy kept. For the scene's axes to be panokit's,
    give the emitter the `to_world` of `panokit.renderer.environment_emitter`, which does all.
    """
    return rows_from_pole_to_pole(envmap.radiance)


def mitsuba_parameter(envmap: EnvironmentMap) -> NDArray[np.float32]:
    """The array for `params["<light>.data"]` of a loaded scene, (H, W + 2, 3) float32."""
    return pad_columns(to_mitsuba(envmap))


def pad_columns(rows: NDArray[np.float32]) -> NDArray[np.float32]:
    """The rows with the column that Mitsuba keeps at each side, from across the seam.

    Without them Mitsuba takes the array silently for another picture.
    """
    return np.concatenate([rows[:, -1:], rows, rows[:, :1]], axis=1)


def from_mitsuba(array: NDArray[np.floating[Any]], *, frame: Frame = Frame.LEVEL) -> EnvironmentMap:
    """A map from a bitmap (H, 2 H, 3) or from the data of a loaded scene (H, 2 H + 2, 3).

    Raises:
        ImageError: If it is neither, or not physical.
    """
    array = np.asarray(array)
    if array.ndim != 3 or array.shape[2] < 3 or array.shape[0] < 2:
        raise ImageError(
            f"Mitsuba's environment data is (H, W, 3), not {array.shape}.", reason="wrong-channels"
        )
    if array.shape[1] == 2 * array.shape[0] + 2:
        array = array[:, 1:-1]
    return EnvironmentMap(radiance=rows_as_cells(array[..., :3]), frame=frame)

"""three.js: the same pixels, as RGBA from the bottom row up.

`new THREE.DataTexture(data, W, H, THREE.RGBAFormat, THREE.FloatType)` with `mapping` set to
`THREE.EquirectangularReflectionMapping` and `flipY` left false; `data` is the array's bytes.
+Y is up and +X is at the center: with d of panokit, (-z, y, x).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.frames import Frame
from panokit.io.adapters.blender import rgb_from_the_top, rgba_from_the_bottom


def to_threejs(envmap: EnvironmentMap) -> NDArray[np.float32]:
    """The data of a float texture, (H, W, 4); `array.tobytes()` is what a Float32Array holds."""
    return rgba_from_the_bottom(envmap.radiance)


def from_threejs(data: NDArray[np.floating[Any]], *, frame: Frame = Frame.LEVEL) -> EnvironmentMap:
    """A map from the data of a texture (H, W, 4) with `flipY` false.

    Raises:
        ImageError: If it is not 2:1, or not physical.
    """
    return EnvironmentMap(radiance=rgb_from_the_top(np.asarray(data, np.float32)), frame=frame)

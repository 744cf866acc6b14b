"""Maps with one bright texel, whose direction is known to the digit."""

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.frames import Frame

HEIGHT = 32
DIM, BRIGHT = 0.01, np.array([400.0, 200.0, 100.0])
# (row, column): beside the front, right, on the seam, near both poles, behind below.
TEXELS = [(15, 32), (9, 50), (17, 0), (1, 11), (30, 40), (22, 63)]


def direction_of(row: int, column: int, height: int = HEIGHT) -> np.ndarray:
    """Where a texel's middle lies, from the convention alone: +X east, +Y up, -Z north."""
    azimuth = ((column + 0.5) / (2 * height) - 0.5) * 2 * np.pi
    elevation = (0.5 - (row + 0.5) / height) * np.pi
    return np.array(
        [
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
            -np.cos(elevation) * np.cos(azimuth),
        ]
    )


@pytest.fixture
def beacon():
    """Makes a map that is dim but for one texel."""

    def make(row: int, column: int, height: int = HEIGHT) -> EnvironmentMap:
        radiance = np.full((height, 2 * height, 3), DIM, np.float32)
        radiance[row, column] = BRIGHT
        return EnvironmentMap(radiance=radiance, frame=Frame.WORLD)

    return make


@pytest.fixture(params=TEXELS, ids=lambda texel: f"row{texel[0]}-column{texel[1]}")
def texel(request):
    """(row, column) of a bright texel."""
    return request.param

"""Maps with colored patches, so that every direction can be told from every other."""

import numpy as np
import pytest

from panokit.envmap import Anchor, EnvironmentMap
from panokit.sphere import equirect_directions

AHEAD, RIGHT, BEHIND, LEFT, UP = (0, 0, -1), (1, 0, 0), (0, 0, 1), (-1, 0, 0), (0, 1, 0)


@pytest.fixture
def patches():
    """A gray map with red ahead, green to the right, a sun of 20000 behind, white above."""
    directions = equirect_directions(256, 128)
    radiance = np.full((128, 256, 3), 0.18, np.float32)
    for toward, color in (
        (AHEAD, (0.5, 0.02, 0.02)),
        (RIGHT, (0.02, 0.25, 0.02)),
        (BEHIND, (20000, 20000, 20000)),
        (LEFT, (0.02, 0.02, 0.6)),
        (UP, (0.9, 0.9, 0.9)),
    ):
        radiance[directions @ np.array(toward) > np.cos(np.deg2rad(15))] = color
    return EnvironmentMap(radiance=radiance, anchor=Anchor.LDR_WHITE)

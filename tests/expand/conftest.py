import numpy as np
import pytest

from panokit.color.camera import CAMERA_A, photograph
from panokit.expand.network import Answer


def lamp_scene(height: int = 128) -> np.ndarray:
    """Dim walls with texture, three lamps of different size; (H, 2H, 3) float32, linear."""
    random = np.random.default_rng(5)
    width = 2 * height
    coarse = random.uniform(0.02, 0.1, (height // 8, width // 8, 1)) * (1, 0.95, 0.9)
    coarse = coarse.astype(np.float32)
    radiance = coarse.repeat(8, axis=0).repeat(8, axis=1)
    unit = height // 64
    radiance[20 * unit : 26 * unit, 30 * unit : 40 * unit] = (60, 50, 40)
    radiance[12 * unit : 15 * unit, 70 * unit : 73 * unit] = 900
    # One across the seam.
    radiance[36 * unit : 38 * unit, : 2 * unit] = 200
    radiance[36 * unit : 38 * unit, -2 * unit :] = 200
    return radiance


@pytest.fixture
def lamps() -> np.ndarray:
    """The lamp scene as camera A shows it, (128, 256, 3) uint8."""
    return photograph(lamp_scene(), CAMERA_A).pixels


class KnownNetwork:
    """Answers like a released model: a fixed gain on the grid and another on components."""

    digest = "0" * 64

    def __init__(self) -> None:
        self.slopes = (1.0, 1.0)
        self.set_gains(4.0, 9.0)

    def set_gains(self, grid: float, component: float) -> None:
        self._grid, self._component = np.log(grid), np.log(component)

    def ask(self, grid, features):
        # It varies with the picture, but with nothing that a roll changes.
        gain = self._grid + 0.1 * (grid[0] - grid[0].mean())
        return Answer(
            log_gain=np.stack([gain] * 3).astype(np.float32),
            slopes=self.slopes,
            component_gain=np.full(len(features), self._component, np.float32),
            sun=np.zeros(len(features), np.float32),
        )


@pytest.fixture
def known_network() -> KnownNetwork:
    return KnownNetwork()

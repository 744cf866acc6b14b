import cv2
import numpy as np
import pytest

from panokit.capture import local_capture
from panokit.frames import angle_between
from panokit.panorama import Panorama
from panokit.sphere import equirect_directions


def textured_pixels(width_px=512, seed=0):
    """Gravel below and a graded sky above, the same grain in every direction."""
    rng = np.random.default_rng(seed)
    grain = rng.normal(0, 1, (256, 256, 256)).astype(np.float32)
    directions = equirect_directions(width_px, width_px // 2)
    cell = np.floor((directions + 1) * 63.9).astype(int)
    noise = cv2.GaussianBlur(grain[cell[..., 0], cell[..., 1], cell[..., 2]], (0, 0), 0.7)
    up = directions[..., 1]
    level = np.where(up < 0, 110 + 40 * noise, 150 + 80 * up)
    color = np.stack([level * 1.05, level, level * np.where(up < 0, 0.85, 1.2)], axis=-1)
    return np.clip(color, 0, 239).astype(np.uint8)


def cap(width_px, direction, radius_deg):
    away = angle_between(equirect_directions(width_px, width_px // 2), np.asarray(direction))
    return away < np.deg2rad(radius_deg)


@pytest.fixture(scope="session")
def textured():
    return textured_pixels


@pytest.fixture(scope="session")
def cap_around():
    return cap


@pytest.fixture(scope="session")
def panorama_of():
    def make(pixels, valid=None, **known):
        return Panorama(pixels=pixels, valid=valid, capture=local_capture("street", **known))

    return make

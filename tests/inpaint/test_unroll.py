import numpy as np
import pytest

from panokit.frames import angle_between
from panokit.inpaint.unroll import COLUMNS, ROW_DEG, rolled_up, unrolled
from panokit.sphere import equirect_directions

WIDTH = 512
CENTERS = [(0.0, -1.0, 0.0), (0.3, -0.9, 0.2), (1.0, 0.0, 0.0)]


@pytest.mark.parametrize("center", CENTERS)
def test_rows_are_angles_from_the_center(center):
    away = angle_between(equirect_directions(WIDTH, WIDTH // 2), np.array(center))
    pixels = np.repeat(np.rint(np.rad2deg(away))[..., None], 3, axis=-1).astype(np.uint8)
    rows = unrolled(pixels, np.array(center))
    angle = (np.arange(len(rows)) + 0.5) * ROW_DEG
    assert np.abs(rows[8:, :, 0] - angle[8:, None]).max() < 2


@pytest.mark.parametrize("center", CENTERS)
def test_what_is_marked_unrolled_is_marked_in_the_panorama(center):
    lit = np.zeros((WIDTH // 2, WIDTH, 3), np.uint8)
    heading = angle_between(equirect_directions(WIDTH, WIDTH // 2), np.array([0.6, -0.5, 0.62]))
    lit[heading < np.deg2rad(15)] = 255
    marked = unrolled(lit, np.array(center))[..., 0] > 127
    mask = rolled_up(marked, np.array(center), WIDTH, WIDTH // 2)
    away = angle_between(equirect_directions(WIDTH, WIDTH // 2), np.array(center))
    within = away < np.deg2rad(len(marked) * ROW_DEG)
    assert marked.shape[1] == COLUMNS
    assert (mask != ((lit[..., 0] > 0) & within)).mean() < 0.002

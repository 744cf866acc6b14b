"""Relit balls stand beside the object, are lit from where the light is, and cast shadows."""

import numpy as np
import pytest

from panokit.app.insertion import _places, insert_balls
from panokit.frames import Rotation

HEIGHT, WIDTH = 180, 320
FLAT = np.full((HEIGHT, WIDTH, 3), 120, np.uint8)


def lamp(direction, level=0.1, peak=60.0):
    from panokit.sphere import equirect_directions

    toward = np.asarray(direction, float) / np.linalg.norm(direction)
    radiance = np.full((64, 128, 3), level, np.float32)
    radiance[equirect_directions(128, 64) @ toward > np.cos(np.deg2rad(8))] = peak
    return radiance


@pytest.fixture
def mask():
    mask = np.zeros((HEIGHT, WIDTH), bool)
    mask[80:140, 130:190] = True
    return mask


def inserted(mask, direction):
    down = Rotation.from_heading_pitch_roll(0, np.deg2rad(-15), 0)
    return insert_balls(FLAT, mask, lamp(direction), down, 60.0).astype(int)


def test_balls_are_brighter_where_the_lamp_is(mask):
    left, right = (inserted(mask, (x, 0.8, 1.0)) for x in (-1, 1))
    (x, y), size = _places(mask)[0]
    x, y, reach = int(x), int(y), int(0.3 * size)
    assert left[y, x - reach].mean() > left[y, x + reach].mean() + 20
    assert right[y, x + reach].mean() > right[y, x - reach].mean() + 20


def test_shadows_fall_away_from_the_lamp(mask):
    left, right = (inserted(mask, (x, 0.7, 0.3)) for x in (-1, 1))
    (x, y), size = _places(mask)[0]
    ground = int(y + 0.45 * size)
    west = np.s_[ground : ground + 6, int(x - 1.1 * size) : int(x - 0.6 * size)]
    east = np.s_[ground : ground + 6, int(x + 0.6 * size) : int(x + 1.1 * size)]
    # What is left of the mask's own object is shaded by neither.
    assert left[west].min() > 110
    assert left[east].min() < left[west].min() - 10
    assert right[west].min() < right[west].max()
    assert right[west].mean() < left[west].mean() - 5


def test_the_object_stays_as_it_is(mask):
    picture = inserted(mask, (1, 0.8, 0.2))
    assert np.abs(picture[mask] - 120).max() <= 1


def test_above_the_horizon_nothing_is_shaded(mask):
    picture = inserted(mask, (1, 0.8, 0.2))
    assert np.abs(picture[:20] - 120).max() <= 1


@pytest.mark.parametrize("columns", [slice(4, 60), slice(260, 316)])
def test_balls_stay_inside_the_frame_where_the_object_is_at_its_side(columns):
    mask = np.zeros((HEIGHT, WIDTH), bool)
    mask[60:150, columns] = True
    for (x, y), size in _places(mask):
        assert size / 2 <= x <= WIDTH - size / 2
        assert size / 2 <= y <= HEIGHT - size / 2


def test_in_the_dark_nothing_breaks(mask):
    dark = np.zeros((64, 128, 3), np.float32)
    picture = insert_balls(FLAT, mask, dark, Rotation.identity(), 60.0)
    (x, y), _ = _places(mask)[0]
    assert picture[int(y), int(x)].max() == 0

import numpy as np
import pytest

from panokit.inpaint.legs import find_legs
from panokit.inpaint.unroll import COLUMNS, ROW_DEG, rolled_up

DOWN = np.array([0.0, -1, 0])
WIDTH = 1024
PLATE_DEG = 8.0


def wedges(azimuths_deg, end_deg=14.0, width_deg=14.0):
    """Legs as they look from above: from below the plate to a tip, (H, W) bool."""
    marked = np.zeros((round(end_deg / ROW_DEG), COLUMNS), bool)
    angle = (np.arange(len(marked)) + 0.5) * ROW_DEG
    half = width_deg / 2 * np.clip((end_deg - angle) / (end_deg - PLATE_DEG), 0, 1)
    around = np.arange(COLUMNS) / COLUMNS * 360
    for azimuth_deg in azimuths_deg:
        apart = np.abs((around - azimuth_deg + 180) % 360 - 180)
        marked |= apart[None] < half[:, None]
    return rolled_up(marked, DOWN, WIDTH, WIDTH // 2)


@pytest.fixture
def ground(textured, cap_around):
    pixels = textured(WIDTH)
    pixels[cap_around(WIDTH, DOWN, PLATE_DEG)] = 30
    return pixels


@pytest.mark.parametrize("azimuths_deg", [(0, 120, 240), (40, 165, 281), (179, 300)])
def test_legs_are_found_to_their_tips(ground, azimuths_deg):
    legs = wedges(azimuths_deg)
    ground[legs] = 25
    found, count = find_legs(ground, DOWN, PLATE_DEG)
    assert count == len(azimuths_deg)
    assert found[legs].mean() > 0.97
    # And little else: a degree or two beside them.
    assert found[~wedges(azimuths_deg, end_deg=17, width_deg=24)].mean() < 0.002


def test_a_plate_without_legs_has_none(ground):
    found, count = find_legs(ground, DOWN, PLATE_DEG)
    assert (found.any(), count) == (False, 0)


def test_one_shadow_is_no_tripod(ground):
    ground[wedges((70,))] = 25
    assert find_legs(ground, DOWN, PLATE_DEG)[1] == 0


def test_what_goes_on_and_on_is_no_leg(ground):
    ground[wedges((0, 120, 240), end_deg=60)] = 25
    assert find_legs(ground, DOWN, PLATE_DEG)[1] == 0


def test_a_dark_half_of_the_ground_is_no_leg(ground):
    ground[:, : WIDTH // 3] = ground[:, : WIDTH // 3] // 2
    assert find_legs(ground, DOWN, PLATE_DEG)[1] == 0

"""A click selects the object and not its background."""

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.lighting import Box, flood, select_object, selection_from_mask
from panokit.lighting.settings import SelectSettings
from tests.lighting.clips import RADIUS, frame

BALL = Box(x=160 - RADIUS, y=90 - RADIUS, width=2 * RADIUS, height=2 * RADIUS)


@pytest.mark.parametrize("click", [(160, 90), (150, 75), (175, 105)])
def test_a_click_selects_the_whole_ball_from_light_to_shade(click):
    found = select_object(frame(), click)
    assert found.box.overlap(BALL) > 0.9
    assert found.problem == ""
    assert not found.touches_edge
    assert not found.mask.flags.writeable
    assert found.mask.shape == (180, 320)
    assert abs(found.mask.sum() / (np.pi * RADIUS**2) - 1) < 0.06


def test_a_large_frame_gives_a_mask_of_its_size():
    large = np.repeat(np.repeat(frame(), 5, axis=0), 5, axis=1)
    found = select_object(large, (800, 450))
    assert found.mask.shape == large.shape[:2]
    assert found.box.overlap(BALL.scaled(5)) > 0.9


def test_a_tolerance_is_obeyed():
    sizes = [flood(frame(), (150, 75), SelectSettings(tolerance=t)).mask.sum() for t in (2, 8, 30)]
    assert 0 < sizes[0] < sizes[1] < sizes[2]


def test_growing_can_be_left_out():
    picture = frame()
    picture[85:95, 150:170] = 250
    with_it = select_object(picture, (150, 75))
    without = flood(picture, (150, 75), SelectSettings(grow=False))
    assert with_it.box.overlap(BALL) > 0.9
    assert without.mask.sum() < with_it.mask.sum()


def test_a_highlight_belongs_to_the_ball():
    picture = frame()
    picture[70:75, 145:150] = 250
    assert select_object(picture, (160, 100)).mask[72, 147]


def test_a_hole_that_shows_the_background_stays_a_hole():
    picture = frame(radius=60)
    rows, columns = np.mgrid[:180, :320]
    through = np.hypot(rows - 90, columns - 160) < 28
    picture[through] = frame(x=-100)[through]
    found = select_object(picture, (160, 45), SelectSettings(grow=False, tolerance=25))
    assert not found.mask[90, 160]


@pytest.mark.parametrize("click", [(20, 20), (300, 170)])
def test_a_click_on_an_even_wall_is_recognized(click):
    picture = frame()
    wall = picture[..., 0] < picture[..., 2] * 1.2
    picture[wall] = 120
    with pytest.raises(ImageError, match="on the background") as caught:
        select_object(picture, click)
    assert caught.value.reason == "background"
    shown = flood(picture, click)
    assert shown.mask.mean() > 0.5  # the mask is there, for a person to look at
    assert shown.problem


def test_a_frame_of_one_color_is_all_background():
    with pytest.raises(ImageError, match="on the background"):
        select_object(np.full((180, 320, 3), 90, np.uint8), (10, 10))


def test_a_speck_is_too_small():
    picture = np.full((180, 320, 3), 90, np.uint8)
    picture[90:93, 160:163] = [250, 40, 40]
    with pytest.raises(ImageError, match="too small") as caught:
        select_object(picture, (161, 91), SelectSettings(tolerance=10))
    assert caught.value.reason == "too-small"


@pytest.mark.parametrize("click", [(-1, 5), (320, 5), (5, 180)])
def test_a_click_beside_the_frame_is_refused(click):
    with pytest.raises(UsageError, match="beside the frame of 320x180"):
        select_object(frame(), click)


@pytest.mark.parametrize(
    "picture",
    [np.zeros((9, 9), np.uint8), np.zeros((9, 9, 4), np.uint8), np.zeros((9, 9, 3), np.float32)],
)
def test_what_is_no_rgb_frame_is_refused(picture):
    with pytest.raises(UsageError, match=r"\(H, W, 3\) uint8 RGB"):
        flood(picture, (4, 4))


def test_an_object_at_the_edge_is_known_to_be_cut_off():
    assert select_object(frame(x=10), (12, 90)).touches_edge


def test_a_mask_drawn_by_hand_is_a_selection():
    mask = np.zeros((180, 320), bool)
    mask[20:60, 40:100] = True
    found = selection_from_mask(mask)
    assert found.box == Box(x=40, y=20, width=60, height=40)
    assert found.tolerance == 0
    assert mask[int(found.seed[1]), int(found.seed[0])]
    with pytest.raises(ImageError, match="mask is empty"):
        selection_from_mask(np.zeros((4, 4), bool))


def test_boxes_overlap_by_intersection_over_union():
    one = Box(x=0, y=0, width=10, height=10)
    assert one.overlap(one) == 1
    assert one.overlap(Box(x=5, y=0, width=10, height=10)) == pytest.approx(1 / 3)
    assert one.overlap(Box(x=50, y=0, width=10, height=10)) == 0

import cv2
import numpy as np
import pytest

from panokit.frames import Rotation
from panokit.inpaint import InpaintSettings, inpaint
from panokit.inpaint.nadir import find_blurred_ground, find_nadir_cap

DOWN = np.array([0.0, -1, 0])
WIDTH = 1024


def test_a_clean_picture_has_no_cap(textured):
    assert find_nadir_cap(textured(WIDTH), DOWN) is None


@pytest.mark.parametrize("radius_deg", [6, 15, 30])
@pytest.mark.parametrize("color", [(0, 0, 0), (230, 230, 230), (40, 90, 180)])
def test_a_disc_is_found_with_its_size(textured, cap_around, radius_deg, color):
    pixels = textured(WIDTH)
    pixels[cap_around(WIDTH, DOWN, radius_deg)] = color
    cap = find_nadir_cap(pixels, DOWN)
    assert cap.cue == "color"
    assert radius_deg <= cap.radius_deg <= radius_deg + 2
    assert cap.confidence > 0.9
    assert cap.is_a_hole


def night(textured):
    """The same gravel as dark as at night: 28 gray levels with a grain of 10."""
    return (textured(WIDTH) * 0.25).astype(np.uint8)


@pytest.mark.parametrize("gray", [20, 36])
def test_a_cap_is_found_at_night_too(textured, cap_around, gray):
    pixels = night(textured)
    around = pixels[~cap_around(WIDTH, DOWN, 15) & cap_around(WIDTH, DOWN, 25)].mean()
    assert abs(gray - around) * np.sqrt(3) < 20
    pixels[cap_around(WIDTH, DOWN, 15)] = gray
    cap = find_nadir_cap(pixels, DOWN)
    assert cap.cue == "color"
    assert cap.radius_deg == pytest.approx(15.75, abs=1)


def test_a_dark_picture_without_a_cap_has_none(textured):
    assert find_nadir_cap(night(textured), DOWN) is None


def test_a_step_too_small_to_see_is_no_cap(textured, cap_around):
    pixels = np.full((WIDTH // 2, WIDTH, 3), 12, np.uint8)
    pixels[cap_around(WIDTH, DOWN, 15)] = 10
    assert find_nadir_cap(pixels, DOWN) is None


def test_a_blurred_cap_is_found(textured, cap_around):
    pixels = textured(WIDTH)
    blurred = cv2.GaussianBlur(pixels, (0, 0), 12, borderType=cv2.BORDER_REFLECT)
    within = cap_around(WIDTH, DOWN, 20)
    pixels[within] = blurred[within]
    cap = find_nadir_cap(pixels, DOWN)
    assert cap.radius_deg == pytest.approx(20, abs=3)


def test_blur_over_half_the_ground_is_reported_but_is_no_hole(textured, cap_around):
    pixels = textured(WIDTH)
    blurred = cv2.GaussianBlur(pixels, (0, 0), 12, borderType=cv2.BORDER_REFLECT)
    within = cap_around(WIDTH, DOWN, 52)
    pixels[within] = blurred[within]
    cap = find_nadir_cap(pixels, DOWN)
    assert cap.radius_deg > 45
    assert not cap.is_a_hole
    assert find_blurred_ground(pixels, DOWN).radius_deg == pytest.approx(52, abs=3)


def test_blurred_ground_is_recorded_and_filled_only_when_asked(textured, cap_around, panorama_of):
    pixels = textured(WIDTH)
    blurred = cv2.GaussianBlur(pixels, (0, 0), 12, borderType=cv2.BORDER_REFLECT)
    within = cap_around(WIDTH, DOWN, 48)
    pixels[within] = blurred[within]
    left = inpaint(panorama_of(pixels))
    (hole,) = left.provenance.steps[-1].values["holes"]
    assert (hole["kind"], hole["filled"]) == ("blurred-ground", False)
    assert hole["confidence"] > 0.8
    assert np.array_equal(left.pixels, pixels)
    settings = InpaintSettings(fill_blurred_ground=True, method="smooth")
    assert (inpaint(panorama_of(pixels), settings).pixels != pixels).any()


def test_a_small_blurred_cap_is_no_blurred_ground(textured, cap_around):
    pixels = textured(WIDTH)
    blurred = cv2.GaussianBlur(pixels, (0, 0), 12, borderType=cv2.BORDER_REFLECT)
    within = cap_around(WIDTH, DOWN, 20)
    pixels[within] = blurred[within]
    assert find_blurred_ground(pixels, DOWN) is None


def test_the_cap_of_a_tilted_camera_is_found_below_the_camera(textured, cap_around):
    below = Rotation.from_heading_pitch_roll(1.0, 0.1, -0.06).apply(DOWN)
    pixels = textured(WIDTH)
    pixels[cap_around(WIDTH, below, 15)] = 20
    assert find_nadir_cap(pixels, below).radius_deg == pytest.approx(16, abs=1)
    # Around the plumb line it is no ring: the edge is at other angles in other directions.
    assert find_nadir_cap(pixels, DOWN) is None


def test_half_a_ring_is_no_cap(textured, cap_around):
    pixels = textured(WIDTH)
    within = cap_around(WIDTH, DOWN, 15)
    within[:, WIDTH // 2 :] = False
    pixels[within] = 10
    assert find_nadir_cap(pixels, DOWN) is None


def test_a_smooth_floor_is_no_cap():
    level = np.linspace(200, 90, WIDTH // 2)[:, None, None]
    pixels = np.broadcast_to(level, (WIDTH // 2, WIDTH, 3)).astype(np.uint8)
    assert find_nadir_cap(pixels, DOWN) is None

import numpy as np
import pytest

from panokit.errors import ImageError
from panokit.sphere import saturated_mask


def street():
    return np.full((64, 128, 3), 90, np.uint8)


def test_a_white_lamp_and_a_sodium_lamp_are_burnt_out():
    pixels = street()
    pixels[10:13, 20:23] = 255
    pixels[30:33, 60:63] = [255, 252, 60]  # its blue never gets there
    mask = saturated_mask(pixels)
    assert mask[10:13, 20:23].all()
    assert mask[30:33, 60:63].all()
    assert mask.sum() == 18


def test_the_rim_of_a_lamp_counts_across_the_seam_and_a_blue_sky_beside_it_does_not():
    pixels = street()
    pixels[:20] = [120, 190, 255]  # a blue sky with its blue at the limit
    pixels[8:11, :2] = 255
    mask = saturated_mask(pixels)
    assert mask[8:11, :2].all()
    assert mask[9, 2]
    assert mask[9, -1]
    assert not mask[9, 4:-3].any()
    assert mask.sum() < 24


def test_a_brake_light_counts_and_a_red_wall_does_not():
    pixels = street()
    pixels[32, 40] = [255, 60, 40]
    pixels[20:50, 80:110] = [255, 60, 40]
    pixels[32, 10] = [60, 70, 255]  # a small piece of sky
    mask = saturated_mask(pixels)
    assert mask[32, 40]
    assert mask.sum() == 1


def test_the_level_can_be_set():
    pixels = street()
    pixels[5, 5] = 240
    assert not saturated_mask(pixels).any()
    assert saturated_mask(pixels, 240).sum() == 1


def test_radiance_is_refused():
    with pytest.raises(ImageError, match="uint8"):
        saturated_mask(np.ones((8, 16, 3), np.float32))
    with pytest.raises(ImageError, match="RGB"):
        saturated_mask(np.ones((8, 16), np.uint8))

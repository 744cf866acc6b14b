"""Pictures in the page, and how bright a map is shown."""

import base64

import numpy as np
import pytest

from panokit.envmap import Anchor, EnvironmentMap
from panokit.io import decode_image
from panokit.report.pictures import display_gain, false_color_palette, picture, thumbnail


def decoded(made):
    head, data = made.uri.split(",")
    assert head == "data:image/jpeg;base64"
    return decode_image(base64.b64decode(data), what="picture")


def test_a_picture_travels_inside_the_page():
    pixels = np.full((20, 40, 3), (200, 100, 50), np.uint8)
    made = picture(pixels, alt="an orange field", caption="Orange")
    assert (made.width_px, made.height_px, made.caption) == (40, 20, "Orange")
    assert np.abs(decoded(made).astype(int) - pixels).max() < 8


def test_a_thumbnail_shows_sources_and_shadows_at_once(patches):
    made = thumbnail(patches, "quay", width_px=128)
    assert (made.width_px, made.height_px, made.alt) == (128, 64, "quay, tone mapped")
    shown = decoded(made)
    assert shown[32, 64, 0] > 2 * shown[32, 64, 1]
    assert shown[32, 0].min() > 240
    assert 40 < shown[50, 80].mean() < 200


def test_a_map_at_the_cameras_white_is_shown_as_it_is_another_by_its_median(patches):
    assert display_gain(patches) == 1.0
    dark = patches.with_changes(radiance=patches.radiance / np.float32(64), anchor=Anchor.RELATIVE)
    # The gray of the patches is both the median and middle gray.
    assert display_gain(dark) == pytest.approx(64, rel=1e-3)


def test_a_black_map_has_pictures_too():
    black = EnvironmentMap(radiance=np.zeros((32, 64, 3), np.float32))
    assert display_gain(black) == 1.0
    assert decoded(thumbnail(black, "night")).max() < 8


def test_false_color_goes_from_blue_to_red():
    palette = false_color_palette().astype(int)
    assert palette.shape == (256, 3)
    assert palette[40, 2] > palette[40, 0] + 100
    assert palette[230, 0] > palette[230, 2] + 100

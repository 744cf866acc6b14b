import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.inpaint.face import face_around, paste
from panokit.sphere import equirect_directions

WIDTH = 256


@settings(max_examples=30, deadline=None)
@given(azimuth=st.floats(-3.1, 3.1), elevation=st.floats(-1.57, 1.57), radius=st.floats(0.02, 0.85))
def test_the_view_shows_the_whole_hole(azimuth, elevation, radius):
    y = np.sin(elevation)
    center = np.array(
        [np.cos(elevation) * np.sin(azimuth), y, -np.cos(elevation) * np.cos(azimuth)]
    )
    face = face_around(center, radius, WIDTH)
    away = np.arccos(np.clip(equirect_directions(WIDTH, WIDTH // 2) @ center, -1, 1))
    hole = away < radius
    (seen,) = face.views(hole.astype(np.uint8) * np.uint8(255))
    border = np.concatenate([seen[0], seen[-1], seen[:, 0], seen[:, -1]])
    assert border.max() == 0
    assert not hole.any() or seen.max() > 0


@pytest.mark.parametrize("center", [(0, -1, 0), (0, 1, 0), (0, 0, 1), (1, 0.3, 0)])
def test_what_is_pasted_back_unchanged_changes_next_to_nothing(center):
    slope = equirect_directions(WIDTH, WIDTH // 2) @ np.array([[60.0, 20, -30]] * 3).T
    smooth = (120 + slope).astype(np.uint8)
    face = face_around(np.array(center, float), 0.4, WIDTH)
    view = face.views(smooth)[0].astype(np.float32)
    y, x = np.mgrid[: face.size_px, : face.size_px] - face.size_px / 2
    opacity = (np.hypot(x, y) < 0.35 * face.size_px).astype(np.float32)
    result = smooth.copy()
    paste(result, face, view, opacity, np.zeros(smooth.shape[:2], bool), slice(0, WIDTH // 2))
    assert np.abs(result.astype(int) - smooth).max() <= 1


def test_without_opacity_nothing_changes(textured):
    pixels = textured(WIDTH)
    face = face_around(np.array([0.0, -1, 0]), 0.3, WIDTH)
    result = pixels.copy()
    white = np.full((face.size_px, face.size_px, 3), 255, np.float32)
    clear = np.zeros((face.size_px, face.size_px), np.float32)
    paste(result, face, white, clear, np.zeros(pixels.shape[:2], bool), slice(0, WIDTH // 2))
    assert np.array_equal(result, pixels)

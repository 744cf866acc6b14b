"""The stereo rig: rows agree, disparity has the right sign, the object fills its share."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.dataset.rig import place_rig
from panokit.dataset.scene import View
from panokit.dataset.settings import RigSettings
from panokit.errors import ImageError
from panokit.frames import Rotation

POSE = {"baseline_m": 0.2, "fill": 0.7, "pitch_deg": -15.0, "roll_deg": 0.0}


def cloud(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-0.5, 0.5, (60, 3))


@given(st.integers(0, 1000), st.floats(-40, 40), st.floats(-20, 20))
def test_points_lie_in_the_same_rows_and_further_right_in_the_left_view(seed, pitch, roll):
    points = cloud(seed)
    left, right = place_rig(RigSettings(), points, **{**POSE, "pitch_deg": pitch, "roll_deg": roll})
    (xl, yl, dl), (xr, yr, dr) = left.project(points), right.project(points)
    np.testing.assert_allclose(yl, yr, atol=1e-6)
    np.testing.assert_allclose(dl, dr, atol=1e-9)
    np.testing.assert_allclose(xl - xr, left.focal_px * 0.2 / dl, rtol=1e-6)


@given(st.integers(0, 1000), st.floats(0.3, 0.8))
def test_the_object_spans_its_share_and_stays_in_both_pictures(seed, fill):
    points = cloud(seed)
    views = place_rig(RigSettings(width_px=128), points, **{**POSE, "fill": fill})
    spans = []
    for view in views:
        column, row, _ = view.project(points)
        assert min(column.min(), row.min()) >= 0
        assert max(column.max(), row.max()) <= 128
        spans.append(max(np.ptp(column), np.ptp(row)) / 128)
    assert max(spans) <= fill + 1e-6
    assert fill > 0.72 or max(spans) > fill - 0.01


@pytest.mark.parametrize("option", ["toe_in", "translate"])
def test_the_center_has_no_disparity_with_toe_in_or_translation(option):
    points = cloud(5)
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    left, right = place_rig(RigSettings(**{option: True}), points, **POSE)
    (xl, *_), (xr, *_) = left.project(center), right.project(center)
    assert xl == pytest.approx(128, abs=1e-6)
    assert xr == pytest.approx(128, abs=1e-6)


def test_toe_in_turns_the_cameras_toward_each_other():
    left, right = place_rig(RigSettings(toe_in=True), cloud(1), **POSE)
    assert -left.world_from_camera.matrix[0, 2] > 0 > -right.world_from_camera.matrix[0, 2]


def test_rays_and_projection_are_inverse():
    view = View(
        name="left", position=(1.0, 2.0, 3.0), fov_deg=50, width_px=9, height_px=7, shift_px=1.5,
        world_from_camera=Rotation.from_heading_pitch_roll(0.3, -0.2, 0.1),
    )  # fmt: skip
    column, row, _ = view.project(np.asarray(view.position) + 3.0 * view.rays())
    x, y = np.meshgrid(np.arange(9) + 0.5, np.arange(7) + 0.5)
    np.testing.assert_allclose(column, x, atol=1e-9)
    np.testing.assert_allclose(row, y, atol=1e-9)


def test_an_object_as_large_as_a_town_is_refused():
    with pytest.raises(ImageError, match="too large"):
        place_rig(RigSettings(), 1e4 * cloud(0), **POSE)

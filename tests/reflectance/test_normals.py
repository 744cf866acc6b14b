"""Normals: noise of a stated size, planes from depth, stereo, rough shapes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.errors import UsageError
from panokit.frames import angle_between
from panokit.reflectance import (
    add_noise,
    hemisphere_normals,
    normals_from_depth,
    normals_from_stereo,
    primitive_normals,
    segment_materials,
)
from panokit.reflectance.primitives import Primitive

FOCAL_PX = 80.0


def view_rays(size):
    across = (np.arange(size) + 0.5 - size / 2) / FOCAL_PX
    x, y = np.meshgrid(across, -across)
    return np.stack([x, y, -np.ones_like(x)], axis=-1)


@pytest.mark.parametrize("smooth_px", [0.0, 2.0])
@pytest.mark.parametrize("mean_deg", [0.0, 5.0, 20.0, 30.0])
def test_noise_is_as_large_as_asked(mean_deg, smooth_px):
    normals, mask = hemisphere_normals(256)
    noisy = add_noise(normals, mask, mean_deg, smooth_px=smooth_px, seed=1)
    off = np.rad2deg(angle_between(noisy[mask], normals[mask]))
    assert off.mean() == pytest.approx(mean_deg, rel=0.05, abs=0.01)
    np.testing.assert_allclose(np.linalg.norm(noisy[mask], axis=-1), 1, atol=1e-5)
    assert not noisy[~mask].any()


def test_smooth_noise_is_alike_in_neighbors():
    normals, mask = hemisphere_normals(128)
    rough = add_noise(normals, mask, 20, seed=1)
    smooth = add_noise(normals, mask, 20, smooth_px=4, seed=1)
    step = {name: angle_between(n[64, 40:80], n[64, 41:81]).mean()
            for name, n in (("rough", rough), ("smooth", smooth))}  # fmt: skip
    assert step["smooth"] < step["rough"] / 3


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.7, 0.7), st.floats(-0.7, 0.7))
def test_a_plane_has_its_normal_everywhere(x, y):
    normal = np.array([x, y, 1.0]) / np.hypot(1, np.hypot(x, y))
    rays = view_rays(32)
    facing = rays @ normal
    depth = np.where(facing < -0.1, -2.0 / np.minimum(facing, -0.1), 0)
    found = normals_from_depth(depth, depth > 0, FOCAL_PX)
    inner = found[8:24, 8:24]
    np.testing.assert_allclose(inner, np.broadcast_to(normal, inner.shape), atol=1e-3)


def test_too_little_surface_has_no_normal():
    depth = np.zeros((9, 9))
    depth[4, 4] = 1
    assert not normals_from_depth(depth, depth > 0, FOCAL_PX).any()


def test_stereo_tells_a_slanted_plane_from_a_facing_one():
    size, baseline = 128, 0.2
    rng = np.random.default_rng(3)
    texture = np.kron(rng.uniform(0.1, 0.9, (256, 256)), np.ones((2, 2)))

    def look(normal, eye_x):
        rays = view_rays(size)
        eye = np.array([eye_x, 0.0, 0.0])
        along = (np.array([0, 0, -2.0]) - eye) @ normal / (rays @ normal)
        point = eye + rays * along[..., None]
        column = ((point[..., 0] + 4) * 64).astype(int) % 512
        row = ((point[..., 1] + 4) * 64).astype(int) % 512
        return np.repeat(texture[row, column][..., None], 3, axis=-1)

    means = []
    for normal in (np.array([0.0, 0, 1]), np.array([0.5, 0, 0.866])):
        found = normals_from_stereo(
            look(normal, -baseline / 2), look(normal, baseline / 2), np.ones((size, size), bool),
            focal_px=FOCAL_PX, baseline_m=baseline, nearest_m=1.0, window_px=21,
        )  # fmt: skip
        means.append(np.median(found[30:-30, 30:-30], axis=(0, 1)))
    assert abs(means[0][0]) < 0.15
    assert means[1][0] == pytest.approx(0.5, abs=0.15)


def test_a_ball_stands_in_for_a_round_thing():
    normals, mask = hemisphere_normals(64)
    found = primitive_normals(mask, Primitive.SPHERE)
    np.testing.assert_allclose(found[mask], normals[mask], atol=0.06)


@pytest.mark.parametrize("shape", list(Primitive))
def test_rough_shapes_have_unit_normals_that_face_the_camera(shape):
    mask = np.zeros((40, 50), bool)
    mask[5:35, 10:44] = True
    found = primitive_normals(mask, shape)
    np.testing.assert_allclose(np.linalg.norm(found[mask], axis=-1), 1, atol=1e-5)
    assert (found[mask][:, 2] >= 0).all()
    assert found[20, 12, 0] < 0 < found[20, 42, 0]
    assert not found[~mask].any()


def test_a_box_has_three_faces_and_shows_its_top_above():
    mask = np.ones((60, 60), bool)
    found = primitive_normals(mask, Primitive.BOX)
    assert len(np.unique(found.reshape(-1, 3).round(5), axis=0)) == 3
    assert found[5, 30, 1] > 0.8
    assert found[50, 30, 1] < 0.5


def test_materials_are_told_by_color_whatever_the_light():
    picture = np.zeros((30, 60, 3))
    picture[:, :20] = (0.8, 0.2, 0.2)
    picture[:, 20:35] = (0.2, 0.7, 0.2)
    picture[:, 35:] = (0.2, 0.2, 0.9)
    picture *= np.linspace(0.6, 1, 30)[:, None, None]
    mask = np.ones((30, 60), bool)
    mask[0] = False
    found = segment_materials(picture, mask, 3)
    parts = (slice(20), slice(20, 35), slice(35, 60))
    assert [set(np.unique(found[1:, part])) for part in parts] == [{2}, {3}, {1}]
    assert not found[0].any()


def test_fewer_colors_than_materials_are_no_error():
    assert set(np.unique(segment_materials(np.ones((4, 4, 3)), np.ones((4, 4), bool)))) == {1}
    assert not segment_materials(np.ones((4, 4, 3)), np.zeros((4, 4), bool)).any()


def test_bad_input_is_named():
    mask = np.ones((4, 4), bool)
    with pytest.raises(UsageError, match="mask"):
        primitive_normals(~mask)
    with pytest.raises(UsageError, match="window"):
        normals_from_depth(np.ones((4, 4)), mask, FOCAL_PX, window_px=4)
    with pytest.raises(UsageError, match="between"):
        segment_materials(np.ones((4, 4, 3)), mask, 0)
    with pytest.raises(UsageError, match="degrees"):
        add_noise(np.ones((4, 4, 3)), mask, 60)
    with pytest.raises(UsageError, match="go together"):
        normals_from_stereo(np.ones((4, 4, 3)), np.ones((4, 3, 3)), mask, focal_px=1, baseline_m=1)
    views = np.ones((4, 4, 3)), np.ones((4, 4, 3))
    with pytest.raises(UsageError, match="too narrow"):
        normals_from_stereo(*views, mask, focal_px=1, baseline_m=1)
    with pytest.raises(UsageError, match="more than 0"):
        normals_from_stereo(*views, mask, focal_px=1, baseline_m=-1)
    with pytest.raises(UsageError, match="focal length"):
        normals_from_depth(np.ones((4, 4)), mask, 0)
    with pytest.raises(UsageError, match="mask of normals"):
        add_noise(np.ones((4, 5, 3)), mask, 10)

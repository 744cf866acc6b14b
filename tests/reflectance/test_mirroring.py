"""Scenes in a mirror."""

import numpy as np
import pytest

from panokit.reflectance.mirroring import (
    direction_difference_deg,
    log_difference,
    mirrored_map,
    mirrored_views,
    read_twice,
)
from tests.lighting.fakes import FakeNetwork, beacon, box_views


def light_of(views):
    """Light that mirrors as the scene does: the brighter side of the pictures, both counted."""
    both = views.left.astype(np.float32) + views.right
    return (both / 255 + views.background / np.float32(255)).astype(np.float32)


def one_eyed(views):
    return (views.left / 255).astype(np.float32)


@pytest.mark.parametrize("exchange", [True, False])
def test_a_mirror_in_a_mirror_shows_the_scene(exchange):
    views = box_views()
    twice = mirrored_views(mirrored_views(views, exchange=exchange), exchange=exchange)
    for name in ("left", "right", "left_object", "right_object", "mask", "background", "parts"):
        np.testing.assert_array_equal(getattr(twice, name), getattr(views, name), name)
    np.testing.assert_allclose(twice.left_level.matrix, views.left_level.matrix, atol=1e-12)


def test_the_mirrored_right_view_is_the_left_one():
    views = box_views()
    other = mirrored_views(views)
    np.testing.assert_array_equal(other.left, views.right[:, ::-1])
    # Near things still lie farther left in the right view: the disparity has the same sign.
    middle = [np.nonzero(m.any(axis=(0, 2)))[0].mean() for m in
              (other.left_object, other.right_object)]  # fmt: skip
    assert middle[0] - middle[1] == 6


def test_normals_are_mirrored_with_the_view_they_belong_to():
    views = box_views()
    views.normals[..., 0] = 1
    kept = mirrored_views(views, exchange=False)
    assert (kept.normals[..., 0] == -1).all()
    assert not mirrored_views(views).normals.any()


def test_a_camera_that_leans_right_leans_left_in_the_mirror():
    views = box_views()
    _, pitch, roll = views.left_level.heading_pitch_roll()
    found = mirrored_views(views).left_level.heading_pitch_roll()
    np.testing.assert_allclose(found, (0, pitch, -roll), atol=1e-9)


def test_a_symmetric_model_gives_the_mirrored_map():
    views = box_views()
    network = FakeNetwork(light_of)
    plain, mirrored = read_twice(network, views)
    np.testing.assert_allclose(plain, mirrored, atol=1e-6)
    np.testing.assert_allclose(
        network.read(mirrored_views(views)), mirrored_map(network.read(views)), atol=1e-6
    )
    assert log_difference(plain, mirrored).max() < 1e-5


def test_one_that_is_not_disagrees_with_itself():
    plain, mirrored = read_twice(FakeNetwork(one_eyed), box_views())
    assert log_difference(plain, mirrored).max() > 0.1


def test_a_factor_of_two_is_its_logarithm_everywhere():
    one = np.random.default_rng(0).lognormal(0, 1, (64, 64, 3)).astype(np.float32)
    np.testing.assert_allclose(log_difference(one, 2 * one), np.log(2), rtol=1e-4)


def test_darker_than_a_thousandth_is_dark():
    dark, darker = (np.full((64, 64, 3), value, np.float32) for value in (1e-3, 0.0))
    assert not log_difference(dark, darker).any()


def test_differences_go_on_across_the_seam():
    one, other = np.ones((64, 64, 3), np.float32), np.ones((64, 64, 3), np.float32)
    other[30, 0] = 50
    apart = log_difference(one, other)
    np.testing.assert_allclose(apart[30, 63], apart[30, 1], rtol=1e-4)


def test_two_suns_differ_by_their_angle():
    one, other = (beacon(d, level=0) for d in ([0, 0, -1], [1, 0, 0]))
    assert direction_difference_deg(one, other) == pytest.approx(90, abs=6)
    assert direction_difference_deg(one, 0 * one) == 90

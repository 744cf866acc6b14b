import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.sphere import (
    cubemap_faces,
    equirect_directions,
    equirect_pixel,
    perspective_view,
    rotate_pixels,
    sample,
)
from panokit.sphere.extension import pad_sphere


def smooth(width):
    directions = equirect_directions(width, width // 2)
    return (0.5 + 0.5 * np.sin(3 * directions)).astype(np.float32)


def test_sampling_is_right_at_the_seam_and_the_poles():
    azimuth = np.array([[np.pi - 1e-3, -np.pi + 1e-3, 0.4, 2.0]])
    elevation = np.array([[0.1, 0.1, np.pi / 2 - 1e-3, -np.pi / 2 + 1e-3]])
    directions = direction_from_azimuth_elevation(azimuth, elevation)
    expected = 0.5 + 0.5 * np.sin(3 * directions)
    np.testing.assert_allclose(sample(smooth(512), directions), expected, atol=2e-3)


def test_padding_goes_on_across_the_pole():
    picture = np.arange(8 * 16, dtype=np.float32).reshape(8, 16)
    padded = pad_sphere(picture, 1)
    assert padded.shape == (10, 18)
    assert padded[0, 1] == picture[0, 8]
    assert padded[5, 0] == picture[4, 15]


def test_an_odd_width_has_no_opposite():
    with pytest.raises(UsageError, match="even"):
        pad_sphere(np.zeros((8, 15), np.float32))
    with pytest.raises(UsageError, match="float64"):
        sample(np.zeros((8, 16)), np.ones((1, 1, 3)))


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_a_beacon_goes_where_the_rotation_says(dtype):
    picture = np.zeros((64, 128, 3), dtype)
    picture[20:23, 40:43] = 200
    pose = Rotation.from_heading_pitch_roll(1.1, 0.4, -0.7)
    was = equirect_directions(128, 64)[21, 41]
    column, row = equirect_pixel(pose.apply(was), 128, 64)
    turned = rotate_pixels(picture, pose)
    assert turned.dtype == dtype
    assert turned[round(float(row)), round(float(column)), 0] == 200


def test_masks_turn_without_new_values():
    mask = np.zeros((32, 64), np.uint8)
    mask[:16] = 255
    turned = rotate_pixels(
        mask, Rotation.from_heading_pitch_roll(0.3, 0.5), interpolation="nearest"
    )
    assert set(np.unique(turned)) == {0, 255}


def test_faces_and_views_agree_and_look_the_right_way():
    picture = np.zeros((64, 128, 3), np.uint8)
    directions = equirect_directions(128, 64)
    picture[directions[..., 0] > 0.99, 0] = 255  # east
    picture[directions[..., 1] > 0.99, 1] = 255  # up
    picture[directions[..., 2] < -0.99, 2] = 255  # north
    faces = cubemap_faces(picture, 32)
    centers = {name: face[15:17, 15:17].mean(axis=(0, 1)) for name, face in faces.items()}
    assert centers["right"][0] == 255
    assert centers["up"][1] == 255
    assert centers["front"][2] == 255
    assert centers["back"].max() == centers["down"].max() == 0
    np.testing.assert_array_equal(perspective_view(picture, 32, 32, 90), faces["front"])


def test_a_view_must_be_narrower_than_half_the_sphere():
    with pytest.raises(UsageError, match="180"):
        perspective_view(np.zeros((8, 16, 3), np.uint8), 4, 4, 180)

import numpy as np
import pytest

from panokit.color import luminance
from panokit.sphere import (
    energy,
    equirect_directions,
    irradiance,
    irradiance_map,
    label_regions,
    light_vector,
    resize_radiance,
    row_solid_angles,
)
from panokit.sphere.solid_angle import row_overlap_weights


def test_a_uniform_sky_gives_pi():
    radiance = np.full((64, 128, 3), 2.0, np.float32)
    np.testing.assert_allclose(energy(radiance), 8 * np.pi, rtol=1e-6)
    received = irradiance(radiance, np.eye(3))
    np.testing.assert_allclose(received, 2 * np.pi, rtol=1e-3)
    np.testing.assert_allclose(light_vector(radiance), 0, atol=1e-5)


def test_a_cosine_sky_matches_the_integral():
    # L = max(0, y): E(up) = 2 pi / 3, E(down) = 0 (integral of cos^2 over the hemisphere).
    up = equirect_directions(256, 128)[..., 1:2]
    radiance = np.repeat(np.maximum(up, 0), 3, axis=2)
    received = irradiance(radiance, np.array([[0.0, 1, 0], [0, -1, 0]]))
    np.testing.assert_allclose(received[0], 2 * np.pi / 3, rtol=1e-3)
    np.testing.assert_allclose(received[1], 0, atol=1e-6)


def test_the_irradiance_map_is_irradiance_of_its_directions():
    rng = np.random.default_rng(0)
    radiance = rng.random((64, 128, 3), np.float32)
    small = irradiance_map(radiance, 16)
    direction = equirect_directions(16, 8)[3, 5]
    np.testing.assert_allclose(small[3, 5], irradiance(radiance, direction), rtol=1e-6)


def test_the_light_vector_points_at_a_single_lamp():
    radiance = np.zeros((64, 128, 3), np.float32)
    radiance[20, 30] = [1, 2, 3]
    vector = light_vector(radiance)
    solid_angle = row_solid_angles(64)[20]
    length = float(luminance(np.array([1.0, 2, 3])) * solid_angle)
    np.testing.assert_allclose(vector, equirect_directions(128, 64)[20, 30] * length, rtol=1e-5)


def test_regions_join_across_the_seam_and_over_the_pole():
    mask = np.zeros((64, 128), bool)
    mask[20, :3] = mask[20, -3:] = True  # one lamp on the seam
    mask[0, 5] = mask[0, 5 + 64] = True  # one lamp on the zenith
    mask[40:44, 50:60] = True
    labels, count = label_regions(mask)
    assert count == 3
    assert labels[20, 0] == labels[20, -1] != labels[40, 50]
    assert labels[0, 5] == labels[0, 69]
    assert set(np.unique(labels)) == {0, 1, 2, 3}
    assert label_regions(np.zeros((8, 16), bool))[1] == 0


def test_row_weights_mix_whole_rows_and_sum_to_one():
    weights = row_overlap_weights(10, 4)
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    assert (weights[0, 3:] == 0).all()


@pytest.mark.parametrize("width", [128, 192, 256])
def test_enlarging_keeps_energy_and_shrinks_back(width):
    rng = np.random.default_rng(3)
    radiance = rng.gamma(0.3, 1.0, (32, 64, 3)).astype(np.float32)
    larger = resize_radiance(radiance, width)
    np.testing.assert_allclose(energy(larger), energy(radiance), rtol=1e-5)
    np.testing.assert_allclose(resize_radiance(larger, 64), radiance, rtol=2e-4, atol=1e-5)

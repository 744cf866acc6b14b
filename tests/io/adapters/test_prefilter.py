"""The GGX lobe: against a sum over the sphere written out, and its laws."""

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.io.adapters import prefilter_ggx
from panokit.sphere import energy, equirect_directions, pixel_solid_angles
from tests.io.adapters.conftest import direction_of


def ggx(half_cosine, alpha):
    """Walter et al. 2007, equation 33, for microfacets at this cosine from the normal."""
    cosine2 = half_cosine**2
    tangent2 = 1 / cosine2 - 1
    return alpha**2 / (np.pi * cosine2**2 * (alpha**2 + tangent2) ** 2)


@pytest.mark.parametrize("roughness", [0.4, 0.7, 1.0])
def test_it_is_the_mean_under_the_lobe(roughness):
    rng = np.random.default_rng(3)
    coarse = rng.uniform(0, 1, (8, 16, 3))
    radiance = np.kron(coarse, np.ones((8, 8, 1))).astype(np.float32)
    made = prefilter_ggx(radiance, roughness)
    height, width = made.shape[:2]
    directions = equirect_directions(128, 64).reshape(-1, 3).astype(np.float64)
    angles = pixel_solid_angles(64).ravel()
    for row, column in [(height // 3, width // 5), (height // 2, 3), (height - 2, width - 2)]:
        mirror = direction_of(row, column, height)
        cosine = directions @ mirror
        half = np.sqrt(np.clip((1 + cosine) / 2, 1e-9, 1))
        weight = angles * np.maximum(cosine, 0) * ggx(half, roughness**2)
        expected = weight @ radiance.reshape(-1, 3) / weight.sum()
        np.testing.assert_allclose(made[row, column], expected, rtol=0.03)


@pytest.mark.parametrize("roughness", [0.0, 0.25, 0.5, 1.0])
def test_a_uniform_map_stays_uniform_and_light_is_never_negative(roughness):
    flat = np.full((32, 64, 3), 2.5, np.float32)
    np.testing.assert_allclose(prefilter_ggx(flat, roughness), 2.5, rtol=1e-5)
    flat[9, 9] = 1e4
    made = prefilter_ggx(flat, roughness)
    assert made.min() > 2
    # The mean light is kept to what the pixels of the lobe allow.
    np.testing.assert_allclose(energy(made), energy(flat), rtol=0.03)


def test_a_mirror_is_the_map_itself_and_rougher_is_flatter():
    radiance = np.full((64, 128, 3), 0.1, np.float32)
    radiance[20, 40] = 100
    assert prefilter_ggx(radiance, 0) is radiance
    peaks = [
        float(prefilter_ggx(radiance, roughness).max()) for roughness in (0, 0.25, 0.5, 0.75, 1)
    ]
    assert peaks == sorted(peaks, reverse=True)
    assert peaks[0] > 20 * peaks[-1]


@pytest.mark.parametrize("roughness", [-0.1, 1.1, float("nan")])
def test_roughness_is_0_to_1(roughness):
    with pytest.raises(UsageError, match="0 to 1"):
        prefilter_ggx(np.ones((8, 16, 3), np.float32), roughness)

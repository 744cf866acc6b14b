"""The sharp filter: close to the truth, and no rings around suns."""

import numpy as np
import pytest

from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.sphere import energy, equirect_directions, rotate_pixels, rotate_radiance
from panokit.sphere.spline import BORDER_PX, spline_coefficients

POSE = Rotation.from_heading_pitch_roll(0.5, 0.4, 0.3)


def fine_waves(directions, wavelength_px=10, width=512):
    """Waves as short as ten pixels at the equator, in every direction."""
    rng = np.random.default_rng(0)
    waves = rng.normal(size=(6, 3))
    waves *= width / wavelength_px / np.linalg.norm(waves, axis=1, keepdims=True)
    phases = rng.uniform(0, 6, (6, 1, 1))
    angles = np.einsum("kd,hwd->khw", waves, directions.astype(np.float64)) + phases
    return (0.5 + np.sin(angles).mean(axis=0) / 2)[..., None].repeat(3, 2).astype(np.float32)


def psnr(result, truth):
    return float(-10 * np.log10(np.mean((result - truth) ** 2)))


def test_the_spline_is_much_closer_to_the_truth_than_linear():
    directions = equirect_directions(512, 256)
    picture = fine_waves(directions)
    truth = fine_waves(POSE.inverse.apply(directions))
    linear = psnr(rotate_pixels(picture, POSE), truth)
    spline = psnr(rotate_pixels(picture, POSE, interpolation="spline"), truth)
    assert 40 < linear < 60
    assert spline > 65
    assert spline > linear + 15
    seam = psnr(rotate_pixels(picture, POSE, interpolation="spline")[:, :4], truth[:, :4])
    assert seam > 65


def test_the_spline_goes_through_the_pixels():
    directions = equirect_directions(64, 32)
    picture = fine_waves(directions, width=64)
    same = rotate_pixels(picture, Rotation.identity(), interpolation="spline")
    np.testing.assert_allclose(same, picture, atol=2e-4)


def test_coefficients_invert_the_splines_own_blur():
    rng = np.random.default_rng(1)
    picture = rng.random((40, 48), np.float32)
    coefficients = spline_coefficients(picture)
    blur = np.array([1, 4, 1]) / 6
    across = sum(w * np.roll(coefficients, s, 1) for w, s in zip(blur, (-1, 0, 1), strict=True))
    both = sum(w * np.roll(across, s, 0) for w, s in zip(blur, (-1, 0, 1), strict=True))
    inner = slice(BORDER_PX, -BORDER_PX)
    np.testing.assert_allclose(both[inner, inner], picture[inner, inner], atol=1e-4)


@pytest.fixture
def sun():
    directions = equirect_directions(512, 256)
    toward = direction_from_azimuth_elevation(0.4, 0.7)
    radiance = np.full((256, 512, 3), 0.5, np.float32)
    radiance[directions @ toward > np.cos(np.deg2rad(1.0))] = 1e5
    return radiance


def test_no_dark_ring_around_a_sun(sun):
    turned = rotate_pixels(sun, POSE, interpolation="spline")
    assert turned.min() >= 0.25
    assert turned.max() <= 1.2e5
    # Three pixels away from the disc the sky is the sky again.
    directions = equirect_directions(512, 256)
    center = POSE.apply(direction_from_azimuth_elevation(0.4, 0.7))
    away = directions @ center < np.cos(np.deg2rad(1.0 + 6 * 360 / 512))
    np.testing.assert_allclose(turned[away], 0.5, rtol=0.01)


def test_radiance_turned_with_the_spline_keeps_its_energy_and_its_sky(sun):
    turned = rotate_radiance(sun, POSE, interpolation="spline")
    np.testing.assert_allclose(energy(turned), energy(sun), rtol=1e-5)
    assert turned.min() > 0.4


def test_eight_bit_pictures_stay_within_their_range():
    picture = np.zeros((64, 128, 3), np.uint8)
    picture[20:40, 30:60] = 255
    turned = rotate_pixels(picture, POSE, interpolation="spline")
    assert turned.dtype == np.uint8
    assert turned.max() == 255
    assert turned.min() == 0

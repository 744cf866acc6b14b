"""Light is the same light however it is written down, turned or blurred."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.frames import Rotation, angle_between, direction_from_azimuth_elevation
from panokit.sphere import (
    blur_radiance,
    energy,
    equirect_directions,
    evaluate_harmonics,
    find_lights,
    fit_gaussians,
    harmonics_degrees,
    harmonics_map,
    irradiance,
    irradiance_harmonics,
    project_harmonics,
    rotate_harmonics,
    rotate_radiance,
    vmf_factors,
)

poses = st.tuples(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1)).map(
    lambda angles: Rotation.from_heading_pitch_roll(*angles)
)
seeds = st.integers(0, 10**6)
D = equirect_directions(256, 128)


def coefficients(seed, order):
    return np.random.default_rng(seed).normal(size=((order + 1) ** 2, 3))


def lamps(turn, count=3, width=256):
    """Soft-edged lamps of different strength in a gray room, turned; the same light exactly."""
    directions = equirect_directions(width, width // 2)
    places = [(0.3, 0.5), (-1.4, 0.1), (2.6, -0.6)][:count]
    radiance = np.full((width // 2, width, 3), 0.2, np.float64)
    for k, place in enumerate(places):
        toward = turn.apply(direction_from_azimuth_elevation(*place))
        away = angle_between(directions, toward)
        radiance += (40 / (k + 1) / (1 + (away / 0.12) ** 12))[..., None] * [1, 0.9, 0.7]
    return radiance.astype(np.float32)


@settings(deadline=None, max_examples=15)
@given(st.integers(0, 10), seeds)
def test_harmonics_are_orthonormal_so_a_map_of_them_comes_back(order, seed):
    given_ones = coefficients(seed, order)
    back = project_harmonics(harmonics_map(given_ones, 64), order, pixels="samples")
    np.testing.assert_allclose(back, given_ones, atol=1e-11)


@settings(deadline=None, max_examples=15)
@given(poses, seeds, st.integers(0, 8))
def test_projecting_the_turned_map_is_turning_the_projection(pose, seed, order):
    light = coefficients(seed, order)
    source = pose.inverse.apply(equirect_directions(64, 32).astype(np.float64))
    turned = evaluate_harmonics(light, source)  # what was in d is in pose.apply(d)
    projected = project_harmonics(turned, order, pixels="samples")
    np.testing.assert_allclose(projected, rotate_harmonics(light, pose), atol=1e-5)


@settings(deadline=None, max_examples=5)
@given(poses, seeds)
def test_turning_pixels_and_turning_coefficients_agree(pose, seed):
    light = coefficients(seed, 4) * 0.1
    light[0] = 10
    radiance = harmonics_map(light, 256).astype(np.float32)
    by_pixels = project_harmonics(rotate_radiance(radiance, pose), 4)
    np.testing.assert_allclose(by_pixels, rotate_harmonics(light, pose), atol=0.01)


@settings(deadline=None, max_examples=20)
@given(poses, poses, seeds)
def test_rotations_of_harmonics_form_the_group_of_rotations(a, b, seed):
    light = coefficients(seed, 8)
    np.testing.assert_allclose(
        rotate_harmonics(light, a @ b), rotate_harmonics(rotate_harmonics(light, b), a), atol=1e-11
    )
    back = rotate_harmonics(rotate_harmonics(light, a), a.inverse)
    np.testing.assert_allclose(back, light, atol=1e-11)
    degree = harmonics_degrees(8)
    for band in range(9):
        before, after = light[degree == band], rotate_harmonics(light, a)[degree == band]
        np.testing.assert_allclose((after**2).sum(axis=0), (before**2).sum(axis=0), rtol=1e-10)


@settings(deadline=None, max_examples=15)
@given(poses)
def test_harmonics_give_the_irradiance_of_an_analytic_sky(pose):
    # L = 1 + 0.5 u + u^2 for u = a . d; with n = a . normal:
    # E = pi + 0.5 (2 pi / 3) n + pi / 4 (1 + n^2).
    axis = pose.apply(np.array([0.0, 1.0, 0.0]))
    u = (D.astype(np.float64) @ axis)[..., None]
    sky = 1 + 0.5 * u + u * u
    light = irradiance_harmonics(project_harmonics(sky, 4, pixels="samples"))
    normals = pose.apply(np.vstack([np.eye(3), -np.eye(3)]))
    n = normals @ axis
    expected = np.pi + np.pi / 3 * n + np.pi / 4 * (1 + n * n)
    np.testing.assert_allclose(evaluate_harmonics(light, normals)[:, 0], expected, rtol=1e-6)
    np.testing.assert_allclose(irradiance(sky, normals)[:, 0], expected, rtol=2e-3)


@settings(deadline=None, max_examples=12)
@given(st.floats(1, 300), st.floats(1, 300), seeds)
def test_one_blur_after_another_is_blurring_by_both_factors(kappa, other, seed):
    light = coefficients(seed, 5) * 0.1
    light[0] = 10
    twice = blur_radiance(blur_radiance(harmonics_map(light, 96), kappa), other)
    factors = vmf_factors(kappa, 5) * vmf_factors(other, 5)
    expected = harmonics_map(light * factors[harmonics_degrees(5), None], 96)
    np.testing.assert_allclose(twice, expected, rtol=0.01)


@settings(deadline=None, max_examples=12)
@given(st.floats(0, 1e5), seeds)
def test_a_blur_keeps_energy_order_and_light(kappa, seed):
    radiance = np.random.default_rng(seed).gamma(0.1, 1, (32, 64, 3)).astype(np.float32)
    blurred = blur_radiance(radiance, kappa)
    np.testing.assert_allclose(energy(blurred), energy(radiance), rtol=1e-5)
    # No direction gets more than the brightest had, or less than nothing.
    assert blurred.min() >= 0
    assert blurred.max() <= radiance.max() * (1 + 1e-3)
    np.testing.assert_allclose(
        blur_radiance(np.roll(radiance, 17, axis=1), kappa), np.roll(blurred, 17, axis=1),
        rtol=1e-4, atol=1e-6,
    )  # fmt: skip


@settings(deadline=None, max_examples=10)
@given(poses)
def test_lights_turn_with_the_map_and_their_energies_stay(pose):
    before = find_lights(lamps(Rotation.identity()))
    after = find_lights(lamps(pose))
    assert len(after.lights) == len(before.lights) == 3
    assert not before.abstained
    assert not after.abstained
    for old, new in zip(before.lights, after.lights, strict=True):
        assert np.degrees(angle_between(pose.apply(old.direction), new.direction)) < 0.7
        np.testing.assert_allclose(new.energy, old.energy, rtol=0.06)
    assert after.dominance == pytest.approx(before.dominance, rel=0.1)


@settings(deadline=None, max_examples=10)
@given(seeds, st.integers(0, 12))
def test_lights_and_ambient_light_are_all_the_light(seed, most):
    radiance = np.random.default_rng(seed).gamma(0.05, 1, (32, 64, 3)).astype(np.float32)
    found = find_lights(radiance, most=most)
    np.testing.assert_allclose(found.energy, energy(radiance), rtol=1e-9)
    assert len(found.lights) <= most
    assert found.ambient.min() >= 0


@settings(deadline=None, max_examples=10)
@given(st.integers(-100, 100))
def test_lights_of_a_map_turned_by_whole_pixels_are_the_same(columns):
    radiance = lamps(Rotation.identity())
    still, rolled = find_lights(radiance), find_lights(np.roll(radiance, columns, axis=1))
    np.testing.assert_array_equal(rolled.regions, np.roll(still.regions, columns, axis=1))


@settings(deadline=None, max_examples=8)
@given(poses, st.integers(1, 6))
def test_gaussians_keep_the_energy_of_any_map(pose, count):
    radiance = lamps(pose)
    fit = fit_gaussians(radiance, count)
    np.testing.assert_allclose(fit.energies.sum(axis=0), energy(radiance), rtol=1e-6)
    assert fit.amplitudes.min() >= 0

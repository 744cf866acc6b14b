"""Pixels and directions match; solid angles cover the sphere; energy is kept."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.sphere import (
    energy,
    equirect_directions,
    equirect_pixel,
    irradiance,
    light_vector,
    perspective_directions,
    pixel_solid_angles,
    resize_radiance,
    rotate_pixels,
    rotate_radiance,
)
from panokit.sphere.perspective import perspective_pixel

sizes = st.integers(1, 64).map(lambda n: 4 * n)
poses = st.tuples(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1)).map(
    lambda angles: Rotation.from_heading_pitch_roll(*angles)
)


def sun_map(width, elevation_deg, azimuth_deg=20.0, diameter_deg=0.533):
    directions = equirect_directions(width, width // 2)
    toward = direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(elevation_deg))
    radiance = np.repeat(0.3 + 0.1 * directions[..., 1:2], 3, axis=2)
    # The pixel nearest to the sun shines even where the disk is smaller than a pixel.
    near = directions @ toward
    radiance[near >= min(np.cos(np.deg2rad(diameter_deg / 2)), near.max())] = [6e4, 5e4, 4e4]
    return radiance.astype(np.float32)


@given(sizes)
def test_pixel_to_direction_to_pixel_is_identity(width):
    height = width // 2
    column, row = equirect_pixel(equirect_directions(width, height), width, height)
    rows, columns = np.mgrid[:height, :width]
    np.testing.assert_allclose(column, columns, atol=1e-3)
    np.testing.assert_allclose(row, rows, atol=1e-3)


@given(st.integers(1, 300))
def test_solid_angles_cover_the_sphere(height):
    assert pixel_solid_angles(height).sum() == pytest.approx(4 * np.pi, rel=1e-12)


@given(st.floats(20, 150), poses)
def test_perspective_pixels_round_trip(fov_deg, pose):
    directions = perspective_directions(24, 16, fov_deg, pose).astype(np.float64)
    column, row, inside = perspective_pixel(directions, 24, 16, fov_deg, pose)
    rows, columns = np.mgrid[:16, :24]
    assert inside.all()
    np.testing.assert_allclose(column, columns, atol=1e-3)
    np.testing.assert_allclose(row, rows, atol=1e-3)


@settings(deadline=None, max_examples=25)
@given(st.floats(-89.5, 89.5), st.sampled_from([64, 96, 128, 256, 510]))
def test_resize_keeps_the_energy_of_a_sun_at_any_elevation(elevation_deg, width):
    radiance = sun_map(512, elevation_deg)
    resized = resize_radiance(radiance, width)
    assert resized.shape == (width // 2, width, 3)
    np.testing.assert_allclose(energy(resized), energy(radiance), rtol=1e-5)


@settings(deadline=None, max_examples=20)
@given(st.floats(-89.5, 89.5), poses)
def test_rotation_keeps_the_energy_and_turns_the_light_vector(elevation_deg, pose):
    radiance = sun_map(512, elevation_deg)
    turned = rotate_radiance(radiance, pose)
    np.testing.assert_allclose(energy(turned), energy(radiance), rtol=1e-5)
    expected = pose.apply(light_vector(radiance))
    # A pixel's light lies at its middle in one sum and is spread over it in the other.
    quarter_pixel = 0.25 * 2 * np.pi / 512
    assert np.linalg.norm(light_vector(turned) - expected) < quarter_pixel * np.linalg.norm(
        expected
    )
    assert turned.min() >= 0


@settings(deadline=None, max_examples=20)
@given(poses)
def test_irradiance_turns_with_the_map(pose):
    radiance = sun_map(256, 35, diameter_deg=6)
    normals = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, -1], [-0.6, 0.8, 0]])
    before = irradiance(radiance, normals)
    after = irradiance(rotate_radiance(radiance, pose), pose.apply(normals))
    # Both sides are evaluated on 128x64 texels, which may put the sun half a texel off.
    np.testing.assert_allclose(after, before, rtol=0.06, atol=0.02 * before.max())


@settings(deadline=None, max_examples=20)
@given(poses)
def test_turning_there_and_back_returns_smooth_pictures(pose):
    directions = equirect_directions(256, 128)
    picture = (0.5 + 0.5 * np.sin(6 * directions)).astype(np.float32)
    back = rotate_pixels(rotate_pixels(picture, pose), pose.inverse)
    assert np.abs(back - picture).max() < 0.02


@given(st.integers(-300, 300))
def test_a_whole_pixel_yaw_is_a_roll(columns):
    radiance = sun_map(64, 20, diameter_deg=10)
    yaw = Rotation.from_heading_pitch_roll(columns / 64 * 2 * np.pi)
    np.testing.assert_array_equal(rotate_radiance(radiance, yaw), np.roll(radiance, columns, 1))

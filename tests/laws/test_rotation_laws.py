"""Rotations form a group, and poses are read back as they were given."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from panokit.frames import (
    Rotation,
    azimuth_elevation_from_direction,
    direction_from_azimuth_elevation,
)

angles = st.floats(-3.1, 3.1)
rotations = st.builds(
    Rotation.from_heading_pitch_roll, angles, st.floats(-1.5, 1.5), st.floats(-3.1, 3.1)
)


def close(a: Rotation, b: Rotation) -> bool:
    return np.allclose(a.matrix, b.matrix, atol=1e-10)


@given(rotations, rotations, rotations)
def test_composition_is_associative_and_applies_right_to_left(a, b, c):
    assert close((a @ b) @ c, a @ (b @ c))
    d = np.array([0.3, -0.5, 0.8])
    np.testing.assert_allclose((a @ b).apply(d), a.apply(b.apply(d)), atol=1e-12)


@given(rotations)
def test_inverse_and_identity(a):
    assert close(a @ a.inverse, Rotation.identity())
    assert close(a @ Rotation.identity(), a)


@given(angles, st.floats(-1.5, 1.5), angles)
def test_pose_is_read_back(heading, pitch, roll):
    rotation = Rotation.from_heading_pitch_roll(heading, pitch, roll)
    assert close(Rotation.from_heading_pitch_roll(*rotation.heading_pitch_roll()), rotation)


@given(angles, st.floats(-1.5, 1.5))
def test_azimuth_elevation_round_trip(azimuth, elevation):
    direction = direction_from_azimuth_elevation(azimuth, elevation)
    back = azimuth_elevation_from_direction(direction)
    np.testing.assert_allclose(back, (azimuth, elevation), atol=1e-9)

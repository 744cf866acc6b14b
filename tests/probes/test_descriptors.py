"""The descriptor: what it must not see, and what it must."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.frames import Rotation
from panokit.probes.descriptors import LENGTH, descriptor, distances
from panokit.sphere import blur_radiance, resize_radiance, rotate_radiance
from tests.conftest import sun_radiance


def textured(seed=0, width=128):
    rng = np.random.default_rng(seed)
    noise = blur_radiance(rng.lognormal(0, 2, (width // 2, width, 3)).astype(np.float32), 60.0)
    return np.asarray(noise * [1.0, 0.8, 0.6], np.float32)


ANGLES = st.floats(-3, 3)


@settings(max_examples=12, deadline=None)
@given(heading=ANGLES, pitch=ANGLES, roll=ANGLES)
def test_turning_the_map_does_not_change_it(heading, pitch, roll):
    radiance = textured()
    turned = rotate_radiance(radiance, Rotation.from_heading_pitch_roll(heading, pitch, roll))
    difference = np.subtract(descriptor(turned), descriptor(radiance))
    assert np.abs(difference).max() < 0.1  # of the spread among real probes


@pytest.mark.parametrize("scale", [1e-4, 100.0])
def test_neither_does_its_scale(scale):
    radiance = textured(1)
    np.testing.assert_allclose(
        descriptor(radiance * np.float32(scale)), descriptor(radiance), atol=0.01
    )


def test_size_counts_little():
    radiance = textured(2, 512)
    half = descriptor(resize_radiance(radiance, 256))
    assert np.linalg.norm(np.subtract(half, descriptor(radiance))) < 0.1


def test_other_light_is_far():
    overcast = np.full((64, 128, 3), 0.5, np.float32)
    sunny = sun_radiance(128, 40, diameter_deg=6)
    warm = np.asarray(overcast * [2.0, 1.0, 0.4], np.float32)
    known = np.array([descriptor(m) for m in (overcast, sunny, warm)])
    for one in known:
        assert np.sort(distances(known, one))[1] > 1
    # Neighbors of a kind are nearer to each other than to another kind.
    evening = descriptor(sun_radiance(128, 20, azimuth_deg=100, diameter_deg=6))
    assert np.argmin(distances(known, np.array(evening))) == 1


def test_a_black_map_has_one_too():
    assert descriptor(np.zeros((16, 32, 3), np.float32)) == (0.0,) * LENGTH
    tiny = descriptor(np.ones((8, 16, 3), np.float32))
    assert len(tiny) == LENGTH
    assert np.isfinite(tiny).all()

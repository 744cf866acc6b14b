"""Distances of pixels to a region."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from panokit.sphere.distance import pixel_distance


@given(st.integers(0, 2**31), st.integers(3, 40), st.integers(3, 40))
def test_distances_are_exact(seed, height, width):
    outside = np.random.default_rng(seed).random((height, width)) < 0.9
    outside[0, 0] = False
    found = pixel_distance(outside)
    assert found.dtype == np.float32
    np.testing.assert_array_equal(found, distance_transform_edt(outside).astype(np.float32))


def test_the_place_in_memory_does_not_count():
    rng = np.random.default_rng(0)
    outside = (rng.random((301, 517)) < 0.999).astype(np.uint8)
    outside[7, 7] = 0
    expected = pixel_distance(outside)
    for offset in range(1, 64, 7):
        room = np.empty(outside.size + 64, np.uint8)
        moved = room[offset : offset + outside.size].reshape(outside.shape)
        moved[:] = outside
        assert np.array_equal(pixel_distance(moved), expected)

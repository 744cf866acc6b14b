"""The published light extraction does what its docstring accuses it of."""

import numpy as np
import pytest

from panokit.metrics import find_light_blobs
from panokit.metrics.envmapnet import envmapnet_lights


def night(*lamps: tuple[int, int, tuple[float, float, float]]) -> np.ndarray:
    """A dark 256x128 map with lamps of 5x5 pixels."""
    radiance = np.full((128, 256, 3), 1e-4, np.float32)
    for row, column, color in lamps:
        rows, columns = range(row - 2, row + 3), range(column - 2, column + 3)
        radiance[np.ix_([r % 128 for r in rows], [c % 256 for c in columns])] = color
    return radiance


def test_a_lamp_is_where_its_center_is_in_the_axes_of_the_code():
    # Row 64 is just below the horizon, column 64 a quarter turn from the left edge.
    (direction,) = envmapnet_lights(night((64, 64, (5, 5, 5))))
    polar, azimuth = 64.5 / 128 * np.pi, (1 - 64.5 / 256) * 2 * np.pi
    expected = [
        np.sin(polar) * np.cos(azimuth),
        np.sin(polar) * np.sin(azimuth),
        np.cos(polar),
    ]
    assert direction == pytest.approx(expected, abs=2e-3)


def test_a_red_lamp_is_no_light_beside_a_blue_one():
    radiance = night((40, 60, (90, 90, 0)), (80, 200, (0, 0, 1)))
    assert len(envmapnet_lights(radiance)) == 1
    assert len(find_light_blobs(radiance)) == 1
    # The corrected extraction finds the bright one, the published code the blue one.
    assert find_light_blobs(radiance)[0].energy[0] > 0.1
    (direction,) = envmapnet_lights(radiance)
    assert np.degrees(np.arccos(direction[2])) == pytest.approx(80.5 / 128 * 180, abs=0.5)


def test_a_lamp_across_the_seam_is_two_or_none():
    equal = night((64, 0, (5, 5, 5)))
    unequal = equal.copy()
    unequal[62:67, :3] *= 1.1
    # Halves of one brightness carry one number and are dropped as a band round the map.
    assert len(envmapnet_lights(equal)) == 0
    assert len(envmapnet_lights(unequal)) == 2
    assert len(find_light_blobs(equal)) == len(find_light_blobs(unequal)) == 1


def test_two_equal_lamps_far_apart_are_dropped():
    radiance = night((64, 20, (5, 5, 5)), (64, 180, (5, 5, 5)))
    assert len(envmapnet_lights(radiance)) == 0
    assert len(find_light_blobs(radiance)) == 2


def test_a_lamp_at_the_zenith_is_dark():
    radiance = night((64, 100, (1, 1, 1)))
    radiance[:3] = 3
    found = envmapnet_lights(radiance)
    assert len(found) == 1
    assert abs(found[0][2]) < 0.1  # the horizon's, not the three times brighter one above
    assert find_light_blobs(radiance)[0].direction[1] > 0.99


def test_lights_come_in_scan_order_not_by_strength():
    radiance = night((30, 50, (1, 1, 1)), (60, 150, (2, 2, 2)))
    found = envmapnet_lights(radiance)
    assert found[0][2] > found[1][2]
    assert find_light_blobs(radiance)[0].strength > find_light_blobs(radiance)[1].strength


def test_a_black_map_has_no_lights():
    assert envmapnet_lights(np.zeros((128, 256, 3), np.float32)).shape == (0, 3)

"""Harmonics as JSON: the numbers are what the convention in the file says."""

import json

import numpy as np
import pytest

from panokit.errors import ImageError, RecordError
from panokit.io.adapters import AnalyticSun, harmonics_from_json, harmonics_json
from panokit.sphere import evaluate_harmonics, pixel_solid_angles
from tests.io.adapters.conftest import BRIGHT, DIM, HEIGHT, direction_of


def functions(direction):
    """The first nine, from the words of the file: +Y is the pole, m = 0 the axis of the pole."""
    x, y, z = direction
    return np.array([
        0.282095, 0.488603 * x, 0.488603 * y, 0.488603 * z, 1.092548 * z * x, 1.092548 * x * y,
        0.315392 * (3 * y * y - 1), 1.092548 * y * z, 0.546274 * (z * z - x * x),
    ])  # fmt: skip


def test_the_numbers_are_those_of_the_beacon(beacon, texel):
    value = json.loads(json.dumps(harmonics_json(beacon(*texel), order=2)))
    solid_angle = pixel_solid_angles(HEIGHT)[texel]
    expected = np.outer(functions(direction_of(*texel)), (BRIGHT - DIM) * solid_angle)
    expected[0] += DIM * 4 * np.pi * 0.282095
    # A texel is not a point: the functions change a little over it.
    np.testing.assert_allclose(value["radiance_rgb"], expected, atol=0.006 * np.abs(expected).max())


def test_a_beacon_is_found_again_in_its_harmonics(beacon, texel):
    coefficients = harmonics_from_json(harmonics_json(beacon(*texel), order=8))
    # Degree 1 alone points at the light; it is x, y, z.
    toward = coefficients[1:4, 0]
    np.testing.assert_allclose(toward / np.linalg.norm(toward), direction_of(*texel), atol=0.01)
    around = np.array([direction_of(row, column) for row in range(32) for column in range(64)])
    brightest = around[np.argmax(evaluate_harmonics(coefficients, around)[:, 0])]
    assert brightest @ direction_of(*texel) > np.cos(np.deg2rad(6))


def test_the_polynomial_gives_what_a_matte_surface_reflects(beacon):
    value = harmonics_json(beacon(9, 50), order=3)
    s = np.array(value["diffuse_polynomial_rgb"])
    x, y, z = direction_of(20, 3)
    told = np.array([1, y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y]) @ s
    rows = np.array(value["irradiance_rgb"])[:9]
    np.testing.assert_allclose(told, functions((x, y, z)) @ rows / np.pi, atol=1e-6)


def test_the_file_says_its_convention_and_its_sun(beacon):
    sun = AnalyticSun(direction=np.array([0.0, 1.0, 0.0]), irradiance=np.array([1.0, 1.0, 1.0]))
    value = harmonics_json(beacon(9, 50), order=1, sun=sun)
    assert "pole +Y" in value["convention"]
    assert value["sun"]["direction"] == [0, 1, 0]
    assert "diffuse_polynomial" not in value
    assert value["frame"] == "world"


def test_other_files_are_told():
    with pytest.raises(RecordError, match="--to harmonics"):
        harmonics_from_json({"schema": "x"})
    good = {"schema": "panokit.harmonics/1", "order": 1, "radiance_rgb": [[1, 1, 1]]}
    with pytest.raises(RecordError, match="damaged"):
        harmonics_from_json(good)


def test_a_map_too_small_for_the_order(beacon):
    with pytest.raises(ImageError, match="order"):
        harmonics_json(beacon(3, 3, height=8), order=8)

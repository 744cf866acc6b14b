"""L*a*b*: as others compute it, and back exactly."""

import colour
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.color.lab import LabScheme, lab_from_rgb, lab_matrices, rgb_from_lab

RGB = np.random.default_rng(0).uniform(0, 1, (50, 3))


def test_lab_is_that_of_colour_science():
    xyz = colour.sRGB_to_XYZ(RGB)
    white = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
    np.testing.assert_allclose(lab_from_rgb(RGB), colour.XYZ_to_Lab(xyz, white), atol=0.02)


def test_white_is_100_and_gray_has_no_color():
    np.testing.assert_allclose(lab_from_rgb(np.ones(3)), [100, 0, 0], atol=1e-9)
    np.testing.assert_allclose(lab_from_rgb(np.full(3, 0.3))[1:], 0, atol=1e-9)


@given(st.lists(st.floats(-0.2, 3.0), min_size=3, max_size=3))
def test_there_and_back_is_exact_beyond_0_and_1_too(values):
    rgb = np.array(values)
    np.testing.assert_allclose(rgb_from_lab(lab_from_rgb(rgb)), rgb, atol=1e-8)


def test_float32_keeps_its_precision():
    rgb = RGB.astype(np.float32)
    back = rgb_from_lab(lab_from_rgb(rgb))
    assert back.dtype == np.float32
    np.testing.assert_allclose(back, rgb, atol=1e-5)


def test_the_rounded_matrices_are_near_but_not_exact():
    pair = lab_matrices(LabScheme.PIX2PIX)
    off = np.abs(pair.rgb_from_xyz @ pair.xyz_from_rgb - np.eye(3)).max()
    assert 1e-6 < off < 2e-3
    near = lab_from_rgb(RGB, LabScheme.PIX2PIX) - lab_from_rgb(RGB)
    assert np.abs(near).max() < 0.2
    back = rgb_from_lab(lab_from_rgb(RGB, LabScheme.PIX2PIX), LabScheme.PIX2PIX)
    assert np.abs(back - RGB).max() > 1e-6


@pytest.mark.parametrize("scheme", list(LabScheme))
def test_shapes_are_kept(scheme):
    picture = np.zeros((4, 5, 3), np.float32)
    assert rgb_from_lab(lab_from_rgb(picture, scheme), scheme).shape == (4, 5, 3)

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.color import luminance, srgb_encode_u8, weighted_percentile
from panokit.color.camera import (
    CAMERA_A,
    CAMERA_B,
    Camera,
    photograph,
    sigmoid_encode,
)
from panokit.errors import ImageError, UsageError
from panokit.sphere import row_solid_angles


def scene(seed: int = 0, height: int = 64) -> np.ndarray:
    random = np.random.default_rng(seed)
    radiance = random.lognormal(0, 1, (height, 2 * height, 3)).astype(np.float32)
    radiance[10:12, 20:23] = 500
    return radiance


def test_camera_a_exposes_the_ninetieth_percentile_of_the_sphere_to_0_8():
    radiance = scene()
    shot = photograph(radiance, CAMERA_A)
    bright = weighted_percentile(
        luminance(radiance * shot.exposure), row_solid_angles(64)[:, None], 90
    )
    assert bright == pytest.approx(0.8, rel=1e-4)
    assert shot.sigmoid is None
    assert shot.jpeg_quality is None


def test_camera_a_is_the_clipped_srgb_picture():
    radiance = scene()
    shot = photograph(radiance, CAMERA_A)
    assert np.array_equal(shot.pixels, srgb_encode_u8(radiance * np.float32(shot.exposure)))
    assert shot.pixels[10:12, 20:23].min() == 255


def test_camera_b_draws_exposure_and_curve_anew_and_repeats_with_the_seed():
    radiance = scene()
    shots = [photograph(radiance, CAMERA_B, seed=seed) for seed in range(40)]
    again = photograph(radiance, CAMERA_B, seed=7)
    assert np.array_equal(again.pixels, shots[7].pixels)
    assert again.sigmoid == shots[7].sigmoid
    n, s = np.array([shot.sigmoid for shot in shots]).T
    assert n.mean() == pytest.approx(0.9, abs=0.06)
    assert s.mean() == pytest.approx(0.6, abs=0.06)
    base = photograph(radiance, CAMERA_A).exposure / 0.8
    levels = np.array([shot.exposure for shot in shots]) / base
    assert 0.4 <= levels.min() < 0.5
    assert 1.0 < levels.max() <= 1.2
    assert {shot.jpeg_quality for shot in shots} == {90}


def test_exposure_is_in_units_of_the_clip_level():
    radiance = scene()
    for camera in (CAMERA_A, CAMERA_B):
        shot = photograph(radiance, camera, seed=3)
        true = luminance(radiance * shot.exposure)
        assert shot.pixels[true > 10].max(axis=1).mean() > 250
        assert shot.pixels[true < 0.2].mean() < 200


@given(n=st.floats(0.5, 1.5), s=st.floats(0.2, 2))
def test_the_sigmoid_keeps_black_and_white_and_rises(n: float, s: float):
    encoded = sigmoid_encode(np.linspace(0, 1, 50, dtype=np.float32), n, s)
    assert encoded[0] == 0
    assert encoded[-1] == pytest.approx(1, abs=1e-5)
    assert (np.diff(encoded) > 0).all()


def test_a_black_map_has_no_exposure():
    with pytest.raises(ImageError) as caught:
        photograph(np.zeros((16, 32, 3), np.float32), CAMERA_A)
    assert caught.value.reason == "black-map"


def test_a_camera_refuses_levels_in_the_wrong_order():
    with pytest.raises(UsageError, match="low <= high"):
        Camera(name="odd", level=(1.0, 0.5))

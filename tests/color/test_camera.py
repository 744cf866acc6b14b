import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.color import luminance, srgb_encode, srgb_encode_u8, weighted_percentile
from panokit.color.camera import (
    CAMERA_A,
    CAMERA_B,
    CAMERA_STREET,
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


def as_first_released(radiance: np.ndarray, camera: Camera, seed: int) -> np.ndarray:
    """The presets as they were before cameras could do more: what scores were measured with."""
    random = np.random.default_rng([seed, 0x63616D])
    level = float(np.exp(random.uniform(*np.log(camera.level))))
    weights = row_solid_angles(len(radiance))[:, None]
    bright = weighted_percentile(luminance(radiance), weights, 90)
    exposed = np.minimum(radiance * np.float32(level / bright), 1)
    if random.random() < camera.sigmoid_share:
        n, s = (max(float(random.normal(*camera.sigmoid_n)), 0.3),
                max(float(random.normal(*camera.sigmoid_s)), 0.1))  # fmt: skip
        raised = np.power(exposed, np.float32(n))
        encoded = np.asarray((1 + s) * raised / (raised + s), np.float32)
    else:
        encoded = srgb_encode(exposed)
    pixels = np.rint(encoded * 255).astype(np.uint8)
    if camera.jpeg_quality is not None:
        quality = int(random.integers(camera.jpeg_quality[0], camera.jpeg_quality[1] + 1))
        options = [cv2.IMWRITE_JPEG_QUALITY, quality]
        data = cv2.imencode(".jpg", np.ascontiguousarray(pixels[..., ::-1]), options)[1]
        pixels = cv2.imdecode(data, cv2.IMREAD_COLOR)[..., ::-1]
    return pixels


@pytest.mark.parametrize("camera", [CAMERA_A, CAMERA_B], ids=lambda camera: camera.name)
@pytest.mark.parametrize("seed", [0, 1, 1_000_000_007])
def test_the_test_cameras_take_the_pictures_they_always_took(camera: Camera, seed: int):
    radiance = scene(3)
    pixels = photograph(radiance, camera, seed=seed).pixels
    assert np.array_equal(pixels, as_first_released(radiance, camera, seed))


def test_the_street_camera_draws_from_everything_it_has():
    radiance = scene(height=16)
    shots = [photograph(radiance, CAMERA_STREET, seed=seed) for seed in range(120)]
    drawn = [shot.development for shot in shots]
    assert {one.response.family for one in drawn} == {"srgb", "gamma", "sigmoid", "toned"}
    assert len({one.response for one in drawn if one.response.family == "toned"}) >= 6
    assert 0.25 < np.mean([one.local > 0 for one in drawn]) < 0.55
    log_red = np.log([one.white_balance[0] for one in drawn])
    assert log_red.std() == pytest.approx(0.06, rel=0.3)
    assert min(one.shot_noise for one in drawn) >= 0.002
    assert max(one.read_noise for one in drawn) <= 0.004
    assert len({shot.jpeg_quality for shot in shots}) > 10
    again = photograph(radiance, CAMERA_STREET, seed=5)
    assert again.development == drawn[5]
    assert np.array_equal(again.pixels, shots[5].pixels)


def test_the_presets_have_neither_noise_nor_another_color():
    for camera in (CAMERA_A, CAMERA_B):
        development = photograph(scene(), camera, seed=2).development
        assert not development.has_noise
        assert development.local == 0
        assert development.white_balance == (1.0, 1.0)


def test_a_camera_refuses_shares_of_more_than_all():
    with pytest.raises(UsageError, match="at most 1"):
        Camera(name="odd", level=(1.0, 1.0), sigmoid_share=0.7, toned_share=0.7)

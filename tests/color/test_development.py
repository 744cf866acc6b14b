import numpy as np
import pytest

from panokit.color import luminance, srgb_decode_u8
from panokit.color.development import (
    LOCAL_MOST,
    Development,
    add_noise,
    develop,
    gaussian_kernel,
    neighborhood,
    noise_field,
    tone_locally,
)
from panokit.errors import ImageError, UsageError


def flat(value: float, height: int = 64) -> np.ndarray:
    return np.full((height, 2 * height, 3), value, np.float32)


def test_noise_grows_with_the_light_as_its_model_says():
    settings = Development(exposure=1, shot_noise=0.05, read_noise=0.01)
    for light in (0.04, 0.25):
        field = noise_field((64, 128, 3), 1)
        noisy = add_noise(flat(light), settings, field)
        expected = np.sqrt(0.05**2 * light + 0.01**2)
        assert noisy.std() == pytest.approx(expected, rel=0.03)
        assert noisy.mean() == pytest.approx(light, rel=0.01)


def test_noise_repeats_with_its_seed_and_is_never_negative():
    dark = Development(exposure=1, read_noise=0.02, noise_seed=4)
    first = develop(flat(0.001), dark)
    assert np.array_equal(first, develop(flat(0.001), dark))
    other = Development(exposure=1, read_noise=0.02, noise_seed=5)
    assert not np.array_equal(first, develop(flat(0.001), other))
    assert add_noise(flat(0), dark, noise_field((64, 128, 3), 4)).min() == 0


def test_noise_does_not_unclip_what_is_far_beyond_white():
    settings = Development(exposure=1, shot_noise=0.02, read_noise=0.004)
    assert develop(flat(50), settings).min() == 255


def test_white_balance_clips_each_channel_at_its_own_light():
    settings = Development(exposure=1, white_balance=(1.3, 0.7))
    pixel = develop(flat(0.9), settings)[0, 0]
    assert pixel[0] == 255
    assert srgb_decode_u8(pixel)[1] == pytest.approx(0.9, rel=0.01)
    assert srgb_decode_u8(pixel)[2] == pytest.approx(0.63, rel=0.01)


def test_local_toning_lifts_a_dark_side_and_keeps_white_and_order():
    light = flat(0.9)
    light[:, :64] = np.linspace(0.01, 0.08, 64)[:, None, None]
    light[30, 20] = 1
    toned = tone_locally(light, 0.4)
    assert toned[30, 20] == pytest.approx([1, 1, 1])
    assert toned.max() <= 1
    lift = toned[32, 32, 0] / light[32, 32, 0]
    assert 1.5 < lift < LOCAL_MOST
    # Far from the dark side, where neighborhoods are brighter than the pivot, nothing changes.
    assert toned[:, 90:100] == pytest.approx(light[:, 90:100], rel=1e-5)
    assert np.array_equal(tone_locally(light, 0.0), light)


def test_a_neighborhood_goes_on_across_the_seam():
    values = np.zeros((32, 64), np.float32)
    values[16, 0] = 1
    spread = neighborhood(values)
    assert spread[16, 63] == pytest.approx(spread[16, 1], rel=1e-5)
    assert spread.sum() == pytest.approx(1, rel=1e-4)
    assert len(gaussian_kernel(1024)) % 2 == 1


def test_order_of_the_steps_clipping_comes_after_noise_and_before_toning():
    settings = Development(exposure=2, local=0.5)
    bright = develop(flat(0.8), settings)
    assert bright.min() == 255
    darker = develop(flat(0.02), settings)
    assert luminance(srgb_decode_u8(darker)).mean() > 0.05


@pytest.mark.parametrize(
    "wrong",
    [
        {"exposure": 0.0},
        {"exposure": float("inf")},
        {"exposure": 1, "white_balance": (0.0, 1.0)},
        {"exposure": 1, "shot_noise": -0.1},
        {"exposure": 1, "local": 1.5},
    ],
)
def test_choices_that_no_camera_has_are_refused(wrong):
    with pytest.raises(UsageError):
        Development(**wrong)


def test_a_map_of_one_channel_is_refused():
    with pytest.raises(ImageError) as caught:
        develop(np.ones((4, 8)), Development(exposure=1))
    assert caught.value.reason == "wrong-shape"

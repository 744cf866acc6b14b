import numpy as np
import pytest

from panokit.color.camera import CAMERA_A, photograph
from panokit.errors import UsageError
from panokit.metrics import score_expansion


def scene() -> np.ndarray:
    random = np.random.default_rng(3)
    radiance = random.lognormal(-2, 0.7, (64, 128, 3)).astype(np.float32)
    radiance[20:23, 40:43] = 300
    return radiance


def test_the_truth_itself_scores_perfectly_whatever_its_scale():
    radiance = scene()
    shot = photograph(radiance, CAMERA_A)
    truth = radiance * np.float32(shot.exposure)
    score = score_expansion(truth * np.float32(0.2), truth, shot.pixels)
    assert score.gain == pytest.approx(5, rel=1e-4)
    assert score.energy_ratio == pytest.approx(1, rel=1e-4)
    assert score.irradiance_max < 1e-4
    assert score.ball < 1e-4
    assert score.pu21_db > 80


def test_a_clipped_lamp_shows_in_every_lighting_score():
    radiance = scene()
    shot = photograph(radiance, CAMERA_A)
    truth = radiance * np.float32(shot.exposure)
    score = score_expansion(np.minimum(truth, 1), truth, shot.pixels)
    assert score.energy_ratio < 0.8
    assert score.beyond_clip_ratio < 0.1
    assert score.irradiance_mean > 0.1
    assert score.light_vector_deg > 10
    assert score.ball > 0.1
    assert set(score.to_json()) >= {"gain", "irradiance_mean", "pu21_crf_db"}


def test_sizes_must_agree():
    with pytest.raises(UsageError):
        score_expansion(
            np.ones((8, 16, 3), np.float32),
            np.ones((16, 32, 3), np.float32),
            np.ones((16, 32, 3), np.uint8),
        )

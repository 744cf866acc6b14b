"""The baselines: complete maps, right way round, better than nothing where they should be."""

from dataclasses import replace

import numpy as np
import pytest

from panokit.color import srgb_decode
from panokit.errors import UsageError
from panokit.evaluate.lighting.background import BackgroundExtrapolation
from panokit.evaluate.lighting.baselines import (
    AmbientColor,
    MeanMap,
    NearestMap,
    RandomMap,
    TrainingMaps,
)
from panokit.evaluate.lighting.inversion import ReflectanceInversion
from panokit.evaluate.lighting.predictors import baselines
from panokit.evaluate.lighting.scoring import DOMINANCE, FIGURES, score_map
from panokit.metrics.lighting import light_vector_error_deg
from panokit.sphere import resize_radiance


@pytest.fixture(scope="module")
def training(samples):
    return TrainingMaps(sample.truth for sample in samples[:3])


def test_every_baseline_gives_a_map_that_can_be_scored(samples, training):
    for predictor in baselines(training):
        found = predictor.predict(samples[4])
        assert found.shape == (64, 64, 3)
        assert found.dtype == np.float32
        assert (found >= 0).all()
        assert set(score_map(found, samples[4].truth)) == {*FIGURES, DOMINANCE}


def test_the_truth_itself_has_no_error(samples):
    scores = score_map(samples[0].truth, samples[0].truth)
    assert scores.pop("energy-ratio") == pytest.approx(1)
    scores.pop(DOMINANCE)
    for name, value in scores.items():
        assert value == pytest.approx(0, abs=2e-2), name


def test_the_nearest_map_of_a_known_scene_is_that_scene(samples, training):
    found = NearestMap(training).predict(samples[1])
    np.testing.assert_array_equal(found, samples[1].truth)


def test_the_random_map_depends_on_the_sample_alone(samples, training):
    one, again = (RandomMap(training).predict(samples[4]) for _ in range(2))
    np.testing.assert_array_equal(one, again)
    assert any(np.array_equal(one, known) for known in training.maps)


def test_the_mean_map_lies_between_the_maps(training):
    mean = MeanMap(training).predict(None)
    assert (mean <= training.maps.max(axis=0) * 1.0001).all()
    assert (mean >= np.minimum(training.maps.min(axis=0), 1e-3) * 0.999).all()


def test_ambient_color_is_that_of_the_view(samples):
    found = AmbientColor().predict(samples[0])
    assert np.ptp(found, axis=(0, 1)).max() == 0
    seen = srgb_decode(samples[0].views.left / np.float32(255))
    np.testing.assert_allclose(found[0, 0], seen.mean(axis=(0, 1)), rtol=1e-4)


def test_without_pixels_to_explain_the_ambient_color_is_the_guess(samples):
    views = samples[0].views
    unknown = replace(samples[0], views=replace(views, normals=np.zeros_like(views.normals)))
    np.testing.assert_array_equal(
        ReflectanceInversion().predict(unknown), AmbientColor().predict(unknown)
    )


def test_the_background_is_seen_where_it_is(samples):
    sample = samples[0]
    found = BackgroundExtrapolation().predict(sample)
    ahead = found[28:36, 30:34].reshape(-1, 3).mean(axis=0)
    true = sample.truth[28:36, 30:34].reshape(-1, 3).mean(axis=0)
    np.testing.assert_allclose(ahead, np.clip(true, 0, 1), rtol=0.25, atol=0.03)


def test_known_normals_tell_where_the_light_is(samples):
    away = [
        light_vector_error_deg(
            *(resize_radiance(m, 64, 32) for m in (ReflectanceInversion().predict(s), s.truth))
        )
        for s in samples
    ]
    assert np.median(away) < 35


def test_no_training_maps_are_refused():
    with pytest.raises(UsageError, match="training maps"):
        TrainingMaps([])

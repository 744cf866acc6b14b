"""Scores of many predictions at once are those of each alone, by the protocols."""

import numpy as np
import pytest

from panokit.evaluate.lighting.published import published_scores
from panokit.evaluate.lighting.scoring import (
    CODING,
    OF_CONTROLS,
    OF_LIGHTS,
    ON_REFLECTANCE,
    ON_SPHERE,
    ON_TARGET,
    RELIT,
    score_map,
    score_maps,
    score_reflectance,
    score_spoiled,
)
from panokit.metrics.protocols import protocol
from panokit.reflectance import hemisphere_normals
from panokit.sphere import resize_radiance


@pytest.fixture
def maps():
    rng = np.random.default_rng(4)
    return [rng.lognormal(-1, 1, (64, 64, 3)).astype(np.float32) for _ in range(3)]


def test_every_figure_is_that_of_its_protocol(maps):
    estimate, truth, _ = maps
    scores = score_map(estimate, truth)
    flat, true = (resize_radiance(one, 64, 32) for one in (estimate, truth))
    for name in ON_TARGET:
        assert scores[name] == pytest.approx(protocol(name).score(estimate, truth))
    for name in (*ON_SPHERE, *OF_LIGHTS, *RELIT):
        expected = protocol(name).score(flat, true)
        assert scores[name] == pytest.approx(expected, rel=1e-5, nan_ok=True), name


def test_many_at_once_are_each_alone(maps):
    one, two, truth = maps
    together = score_maps([one, two, one], truth)
    assert together[0] == pytest.approx(together[2], nan_ok=True, rel=1e-5)
    assert together[1] == pytest.approx(score_map(two, truth), nan_ok=True, rel=1e-5)
    assert together[0]["l1"] != together[1]["l1"]


def test_code_figures_are_sums_over_code_values(maps):
    estimate, truth, _ = maps
    scores = score_map(estimate, truth)
    difference = CODING.encode(estimate).astype(float) - CODING.encode(truth)
    assert scores["code-ssd"] == pytest.approx(float((difference**2).sum()), rel=1e-5)
    assert scores["code-l1"] == pytest.approx(float(np.abs(difference).mean()), rel=1e-5)


def test_the_few_figures_of_controls_are_those_of_all(maps):
    estimate, truth, _ = maps
    few, every = score_spoiled(estimate, truth), score_map(estimate, truth)
    assert set(few) == set(OF_CONTROLS)
    assert few == pytest.approx({name: every[name] for name in few})


def test_reflectance_is_judged_on_the_half_that_is_seen(maps):
    estimate, truth, _ = maps
    beyond = np.where(hemisphere_normals(64)[1][..., None], truth, estimate)
    right = score_reflectance(beyond, truth)
    assert set(right) == set(ON_REFLECTANCE)
    assert right["reflectance-mse"] == right["reflectance-code-ssd"] == 0
    assert right["reflectance-dssim"] == pytest.approx(0, abs=1e-9)
    assert score_reflectance(estimate, truth)["reflectance-mse"] > 0.1


def test_published_protocols_tell_scale_as_they_are_written(maps):
    truth = maps[1]
    same = published_scores(truth, truth, ("spheres", "array", "light-direction"))
    doubled = published_scores(2 * truth, truth, ("spheres", "array"))
    assert same["spheres-mirror-rmse-compat"] == pytest.approx(0, abs=1e-5)
    assert same["array-psnr-db-compat"] == 100
    # The three-sphere protocol normalizes exposure away; the array does not.
    assert doubled["spheres-diffuse-rmse-fixed"] == pytest.approx(0, abs=1e-5)
    assert doubled["array-rmse-fixed"] > 0.01
    assert doubled["array-si-rmse-fixed"] == pytest.approx(0, abs=1e-4)
    assert "light-direction-fixed" not in doubled

"""Runs of the evaluator: complete, resumed, never twice; controls; memory."""

import json

import numpy as np
import pytest

from panokit.errors import RecordError, UsageError
from panokit.evaluate.lighting.baselines import (
    AmbientColor,
    MeanMap,
    NearestMap,
    TrainingMaps,
)
from panokit.evaluate.lighting.controls import CONTROLS
from panokit.evaluate.lighting.run import (
    RESULTS,
    evaluate_lighting,
    memorization,
    read_results,
    summaries,
)


class Counting(AmbientColor):
    name = "counting"

    def __init__(self):
        self.calls = 0

    def predict(self, sample):
        self.calls += 1
        return super().predict(sample)


def test_a_run_goes_on_where_it_stopped(samples, tmp_path):
    predictor = Counting()
    evaluate_lighting([predictor], samples[:2], tmp_path)
    whole = (tmp_path / RESULTS).read_text()
    (tmp_path / RESULTS).write_text(whole + whole.splitlines()[0][:40])  # cut off by a kill
    results = evaluate_lighting([predictor, AmbientColor()], samples[:3], tmp_path)
    assert predictor.calls == 3
    assert len(results) == 6
    pairs = [(r.predictor, r.key) for r in read_results(tmp_path)]
    assert len(set(pairs)) == len(pairs) == 6


def test_a_line_that_was_cut_off_is_scored_again_and_a_damaged_one_is_named(samples, tmp_path):
    evaluate_lighting([AmbientColor()], samples[:2], tmp_path)
    path = tmp_path / RESULTS
    lines = path.read_text().splitlines()
    path.write_text(f"{lines[0]}\n{lines[1][:40]}")
    assert len(read_results(tmp_path)) == 1
    path.write_text(f"{lines[0][:40]}\n{lines[1]}\n")
    with pytest.raises(RecordError, match=r"line 1 is damaged.*Delete the line"):
        read_results(tmp_path)


def test_a_line_says_who_what_and_where(samples, tmp_path):
    evaluate_lighting([AmbientColor()], samples[:1], tmp_path)
    line = json.loads((tmp_path / RESULTS).read_text())
    assert line["predictor"] == "ambient color"
    assert line["place"].startswith("place")
    assert line["scores"]["thesis-dssim"] >= 0


def test_summaries_are_per_predictor(samples, tmp_path):
    training = TrainingMaps(s.truth for s in samples)
    found = evaluate_lighting([AmbientColor(), MeanMap(training)], samples, tmp_path)
    table = summaries(found, "light-vector")
    assert set(table) == {"ambient color", "mean map"}
    assert all(row.n == 6 for row in table.values())


def test_two_of_one_name_are_refused(samples, tmp_path):
    with pytest.raises(UsageError, match="one name"):
        evaluate_lighting([AmbientColor(), AmbientColor()], samples, tmp_path)


def test_controls_change_the_second_view_alone(samples):
    sample = samples[0]
    one = CONTROLS["right is left"](sample, samples)
    np.testing.assert_array_equal(one.views.right, sample.views.left)
    np.testing.assert_array_equal(one.views.left, sample.views.left)
    other = CONTROLS["exchanged"](sample, samples)
    np.testing.assert_array_equal(other.views.left_object, sample.views.right_object)
    stranger = CONTROLS["right of another"](sample, samples)
    assert any(np.array_equal(stranger.views.right, s.views.right) for s in samples[1:])
    assert all(np.array_equal(c.truth, sample.truth) for c in (one, other, stranger))


def test_memory_is_told_from_sight(samples, tmp_path):
    class Sees(AmbientColor):
        name, digest = "sees", "1"

        def predict(self, sample):
            return sample.truth * np.float32(1.01)

    training = TrainingMaps(s.truth for s in samples[:3])
    judged = [Sees(), MeanMap(training), NearestMap(training)]
    found = evaluate_lighting(judged, samples[3:], tmp_path, training=training)
    share = memorization(found)
    assert share["sees"] == 0
    assert share["nearest map (oracle)"] == 1
    assert {row.predictor for row in found if row.scores["memory-nearest"] < 1e-3} == {
        "nearest map (oracle)"
    }

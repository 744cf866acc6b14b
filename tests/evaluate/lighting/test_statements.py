"""What is said of the thesis's statements, from results whose truth is known."""

import json

import numpy as np
import pytest

from panokit.evaluate.lighting.outcome import Outcome, epochs_to_within
from panokit.evaluate.lighting.statements import EPOCHS, STATEMENTS, findings
from panokit.evaluate.lighting.verdicts import Verdict
from tests.evaluate.lighting.made_up import make_up


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    return Outcome(make_up(tmp_path_factory.mktemp("made-up")))


def primary(outcome):
    return {
        (one.statement.first, one.statement.second, one.figure): one
        for one in findings(outcome)
        if one.figure == one.statement.primary
    }


@pytest.mark.parametrize(
    "first, second, word",
    [
        ("concat-shared-deep", "concat-unshared-deep", "reproduced"),
        ("dot-product", "no-background", "reproduced"),
        ("background-branch", "dot-product", "reproduced"),
        ("pyramid", "background-branch", "reproduced"),
        ("dematerial", "dematerial-noise-20", "reproduced"),
        ("pyramid-multi-scale", "pyramid", "holds"),
    ],
)
def test_effects_are_found(outcome, first, second, word):
    found = primary(outcome)[first, second, "code-ssd"]
    assert found.word == word
    assert (found.comparison.n, found.comparison.places, found.comparison.seeds) == (60, 6, 3)
    assert found.comparison.low <= found.comparison.mean <= found.comparison.high


def test_an_effect_of_the_other_sign_is_not_reproduced(tmp_path):
    made = make_up(tmp_path, effects={"dot-product": 0.4, "no-background": 0.0})
    assert primary(Outcome(made))["dot-product", "no-background", "code-ssd"].word == (
        "not reproduced"
    )


def test_trainings_that_had_not_converged_count_for_no_verdict(tmp_path):
    made = make_up(
        tmp_path, effects={"dot-product": 0.0, "no-background": 0.4},
        unfinished=("dot-product-two-core-s1",),
    )  # fmt: skip
    found = primary(Outcome(made))["dot-product", "no-background", "code-ssd"]
    assert found.verdict is Verdict.UNDECIDED
    assert "2 of 3 pairs" in found.why
    assert "not converged" in found.why
    assert found.comparison.high < 0  # told all the same


def test_models_that_saw_the_test_count_for_no_verdict(tmp_path):
    made = make_up(
        tmp_path, effects={"dot-product": 0.0, "no-background": 0.4},
        seen={"no-background-two-core-s2": ["place 1"]},
    )  # fmt: skip
    found = primary(Outcome(made))["dot-product", "no-background", "code-ssd"]
    assert found.verdict is Verdict.UNDECIDED
    assert "saw a place" in found.why


def test_one_seed_decides_nothing(tmp_path):
    made = make_up(tmp_path, seeds=1, effects={"dot-product": 0.0, "no-background": 0.4})
    assert primary(Outcome(made))["dot-product", "no-background", "code-ssd"].word == "undecided"


def test_faster_curves_are_told_by_their_epochs(outcome):
    found = primary(outcome)["dot-product", "concat-shared", EPOCHS]
    assert found.word == "reproduced"
    assert found.comparison.mean < -1


def test_statements_of_absent_experiments_are_left_out(tmp_path):
    made = make_up(tmp_path, effects={"dot-product": 0.0, "no-background": 0.4})
    assert {one.statement.number for one in findings(Outcome(made))} <= {"5.4", "3.1"}


def test_every_statement_is_of_experiments_of_the_suite():
    from panokit.evaluate.lighting.experiments import EXPERIMENTS

    assert {name for one in STATEMENTS for name in (one.first, one.second)} <= set(EXPERIMENTS)
    assert {one.number for one in STATEMENTS} >= {f"5.{n}" for n in range(1, 7)}


def test_epochs_to_within_5_percent_of_the_end():
    assert epochs_to_within([10, 3, 1.04, 1.2, 1.01, 1.0]) == 3
    assert epochs_to_within([1.0, 1.0]) == 1
    assert epochs_to_within([9.0, 1.0]) == 2
    # The end is the mean of the last fifth: 1.5.
    assert epochs_to_within([9, 8, 7, 6, 5, 4, 3, 1.57, 2.0, 1.0]) == 8
    assert epochs_to_within([5.0]) == 1


def test_scores_of_an_entrant_are_means_over_seeds(outcome):
    entrant = outcome.entrant("panokit")
    each = [outcome.values(member, "code-ssd") for member in entrant.members]
    np.testing.assert_allclose(outcome.scores(entrant, "code-ssd"), np.mean(each, axis=0))
    spread = outcome.spread(entrant, "code-ssd")
    assert spread.low < spread.mean < spread.high
    assert spread.seeds[0] <= spread.mean <= spread.seeds[1]


def test_a_seed_that_has_no_value_of_a_figure_is_not_counted(tmp_path):
    folder = make_up(tmp_path, samples=12)
    path = folder / "results.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    blind = Outcome(folder).entrant("panokit").members[1]
    for line in lines:
        if line["predictor"] == blind:
            line["scores"].pop("peak", None)
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    outcome = Outcome(folder)
    spread = outcome.spread(outcome.entrant("panokit"), "peak")
    others = [one for one in outcome.entrant("panokit").members if one != blind]
    means = [float(outcome.values(one, "peak").mean()) for one in others]
    assert spread.seeds == (min(means), max(means))

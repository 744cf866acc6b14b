"""The models of all arms on the same samples of held-out places, and what decides between them."""

import math
from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from panokit.console import Console
from panokit.errors import UsageError
from panokit.pipeline.batch import BatchResult
from panokit.pipeline.once import do_once, folder_of
from panokit.pipeline.settings import EvaluateStage, PipelineSettings
from panokit.records import Receipt, RunFolder, stage_key

if TYPE_CHECKING:
    from panokit.evaluate.lighting.predictors import LightingPredictor
    from panokit.evaluate.lighting.run import Result
    from panokit.evaluate.lighting.verdicts import Verdict

VERSION = "2"
SPLIT = "test"
# Intervals are over places; of fewer they promise what they cannot keep.
FEWEST_PLACES, TOO_FEW = 10, "too few places"


def evaluate_arms(
    settings: PipelineSettings,
    run: RunFolder,
    console: Console,
    datasets: Sequence[Receipt],
    models: Sequence[Receipt],
) -> BatchResult:
    """Score every arm's model on the test split of the first arm's dataset.

    The first arm is that of the reference maps, if the pipeline has it: the held-out places then
    have light of true range.

    Raises:
        UsageError: If there is no sample to score on.
    """
    asked = settings.evaluate
    if asked is None:
        raise UsageError("This pipeline has no table evaluate.")
    judge = next((one for one in datasets if one.item == "references"), datasets[0])
    inputs = [judge.key, *(f"{model.item}:{model.key}" for model in models)]
    key = stage_key("evaluate", VERSION, asked.digest, inputs)
    folder = folder_of(run.models, "scores", key)

    def work() -> Mapping[str, Any]:
        results = _scored(asked, folder, console, judge.path, models)
        return _figures(asked, results, [model.path.name for model in models])

    return BatchResult(
        stage="evaluate", receipts=(do_once("evaluate", "scores", folder, key, work),)
    )


def _scored(
    asked: EvaluateStage,
    folder: Path,
    console: Console,
    dataset: Path,
    models: Sequence[Receipt],
) -> list["Result"]:
    # Here, because a run that is finished needs none of it.
    from panokit.dataset.storage.read import StereoDataset
    from panokit.evaluate.lighting.baselines import AmbientColor, MeanMap, TrainingMaps
    from panokit.evaluate.lighting.predictors import NetworkPredictor
    from panokit.evaluate.lighting.run import evaluate_lighting
    from panokit.evaluate.lighting.sample import Samples

    predictors: list[LightingPredictor] = [
        NetworkPredictor(model.path, name=model.item) for model in models
    ]
    if asked.baselines:
        training = StereoDataset(dataset, "train", members=("env64.exr",))
        maps = TrainingMaps(sample["env64"] for sample in training)
        predictors += [MeanMap(maps), AmbientColor()]
    samples = Samples(dataset, SPLIT, asked.count)
    with console.stage("evaluate", len(samples), unit="samples") as tick:
        results = evaluate_lighting(predictors, samples, folder, tick=tick)
    # Lines of models that were trained otherwise may be left there.
    now = {predictor.name for predictor in predictors}
    return [result for result in results if result.predictor in now]


def _figures(
    asked: EvaluateStage, results: Sequence["Result"], models: Sequence[str]
) -> dict[str, Any]:
    """Means by predictor and figure, and the comparison of the arms; no times in it."""
    from panokit.evaluate.lighting.scoring import FIGURES
    from panokit.evaluate.lighting.verdicts import compare

    names = list(dict.fromkeys(result.predictor for result in results))
    by_name = {name: [r for r in results if r.predictor == name] for name in names}
    scores = {
        name: {
            figure: _mean([r.scores[figure] for r in own])
            for figure in FIGURES
            if figure in own[0].scores
        }
        for name, own in by_name.items()
    }
    place_of = {result.key: result.place for result in results}
    comparisons = []
    arms = [name for name in ("augmented", "references") if name in by_name]
    for first, second in combinations(arms, 2):
        one, other = (
            {r.key: r.scores[asked.figure] for r in by_name[name]} for name in (first, second)
        )
        found = compare([one], [other], place_of)
        told = {n: round(getattr(found, n), 5) for n in ("mean", "low", "high", "relative")}
        verdict = _in_words(found.verdict) if found.places >= FEWEST_PLACES else TOO_FEW
        comparisons.append(
            {"first": first, "second": second, "figure": asked.figure, **told, "verdict": verdict}
        )
    return {
        "figure": asked.figure,
        "models": list(models),
        "samples": len({r.key for r in results}),
        "places": len(set(place_of.values())),
        "scores": scores,
        "comparisons": comparisons,
    }


def _in_words(verdict: "Verdict") -> str:
    """What the interval says of the first of two."""
    return {"reproduced": "better", "not reproduced": "worse"}.get(str(verdict), "undecided")


def _mean(values: Sequence[float]) -> float | None:
    """The mean of what is finite; None where nothing is."""
    from panokit.metrics.statistics import summarize

    finite = [value for value in values if math.isfinite(value)]
    return round(summarize(finite).mean, 5) if finite else None

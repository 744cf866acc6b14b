"""Score predictors on a dataset: one line of results.jsonl for each predictor and sample.

What was scored is not scored again, so a run that was stopped goes on, and a model that is
added later costs only itself. All tables and figures are made from these lines.
"""

import json
import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import RecordError, UsageError
from panokit.evaluate.lighting.baselines import TrainingMaps, log_distance
from panokit.evaluate.lighting.controls import Control, controls_of
from panokit.evaluate.lighting.kept import Kept
from panokit.evaluate.lighting.models import ModelFacts
from panokit.evaluate.lighting.predictors import LightingPredictor
from panokit.evaluate.lighting.published import published_scores
from panokit.evaluate.lighting.sample import StereoSample
from panokit.evaluate.lighting.scoring import score_maps, score_reflectance, score_spoiled
from panokit.evaluate.lighting.settings import LightingEvaluation
from panokit.io.files import storage_error, write_bytes
from panokit.metrics.statistics import Summary, summarize

RESULTS = "results.jsonl"
TO_TRUTH, TO_MEMORY = "memory-truth", "memory-nearest"
_NOTHING = LightingEvaluation(controls=0, protocol=(), protocol_count=0, keep=0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """One prediction's figures.

    Attributes:
        predictor: Who predicted.
        key: Of the sample.
        place: Where the light is from.
        category: The kind of scene, "" where it is not known.
        seconds: That the prediction took.
        scores: By the protocols' names; NaN where there is none.
        digest: Of the predictor.
        control: How its input was spoiled; "" for not at all.
    """

    predictor: str
    key: str
    place: str
    category: str
    seconds: float
    scores: Mapping[str, float]
    digest: str = ""
    control: str = ""

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        record = {name: getattr(self, name) for name in self.__slots__}
        finite = {name: value if math.isfinite(value) else None
                  for name, value in self.scores.items()}  # fmt: skip
        return record | {"scores": finite}

    @classmethod
    def from_json(cls, record: dict[str, Any]) -> "Result":
        """What `to_json` wrote."""
        scores = {name: math.nan if value is None else value
                  for name, value in record["scores"].items()}  # fmt: skip
        return cls(**(record | {"scores": scores}))

    @property
    def what(self) -> tuple[str, str, str, str]:
        """What it is the result of."""
        return self.predictor, self.digest, self.key, self.control


@dataclass(frozen=True, slots=True, kw_only=True)
class _Task:
    predictor: LightingPredictor
    control: str
    spoil: Control | None

    @property
    def facts(self) -> ModelFacts | None:
        return getattr(self.predictor, "facts", None)

    @property
    def judges_light(self) -> bool:
        return self.facts is None or self.facts.predicts_light


def evaluate_lighting(
    predictors: Sequence[LightingPredictor],
    samples: Sequence[StereoSample],
    out: Path,
    *,
    settings: LightingEvaluation = _NOTHING,
    training: TrainingMaps | None = None,
    tick: Callable[[], object] = lambda: None,
) -> list[Result]:
    """Score each predictor on each sample.

    Args:
        predictors: With names of their own. What is there of one under another digest is dropped.
        samples: In any order.
        out: Gets results.jsonl; what is there counts as done.
        settings: On how many samples controls and published protocols run, and how many are kept.
        training: Gives each prediction its distance to the nearest map of it.
        tick: Called after each sample.

    Returns:
        All results, those of earlier runs too.

    Raises:
        UsageError: If two predictors have one name.
        StorageError: If the file cannot be read or written.
        RecordError: If a line of it is damaged.
    """
    names = [predictor.name for predictor in predictors]
    if len(set(names)) < len(names):
        raise UsageError(f"Two predictors have one name: {', '.join(names)}. Rename one.")
    now = {predictor.name: predictor.digest for predictor in predictors}
    results = [r for r in read_results(out) if now.get(r.predictor, r.digest) == r.digest]
    done = {result.what for result in results}
    path = out / RESULTS
    try:
        out.mkdir(parents=True, exist_ok=True)
        # Without a last line that was cut off: the next one would go on in it.
        write_bytes(path, "".join(json.dumps(r.to_json()) + "\n" for r in results).encode())
        with path.open("a", encoding="utf-8") as file:
            judge = _Judge(predictors, samples, out, settings, training)
            for number in range(len(samples)):
                for result in judge.missing(number, done):
                    file.write(json.dumps(result.to_json()) + "\n")
                    results.append(result)
                file.flush()
                tick()
    except OSError as error:
        raise storage_error("write", path, error) from error
    return results


class _Judge:
    """Predicts and scores, a sample at a time."""

    def __init__(
        self,
        predictors: Sequence[LightingPredictor],
        samples: Sequence[StereoSample],
        out: Path,
        settings: LightingEvaluation,
        training: TrainingMaps | None,
    ) -> None:
        self._samples, self._settings, self._training = samples, settings, training
        self._keys = getattr(samples, "keys", None) or [one.key for one in samples]
        self._kept = Kept(out)
        self._plain = [_Task(predictor=one, control="", spoil=None) for one in predictors]
        self._spoiled = [
            _Task(predictor=task.predictor, control=name, spoil=control)
            for task in self._plain
            if task.facts is not None
            for name, control in controls_of(task.facts).items()
        ]

    def missing(self, number: int, done: set[tuple[str, str, str, str]]) -> Iterator[Result]:
        """The results of one sample that are not there yet."""
        tasks = [*self._plain, *(self._spoiled if number < self._settings.controls else ())]
        key = self._keys[number]
        tasks = [
            task
            for task in tasks
            if (task.predictor.name, task.predictor.digest, key, task.control) not in done
        ]
        if not tasks:
            return
        sample = self._samples[number]
        to_light = [task for task in tasks if task.judges_light]
        to_reflectance = [task for task in tasks if not task.judges_light]
        plain = [task for task in to_light if not task.control]
        if plain:
            predicted = [self._predict(task, sample) for task in plain]
            rows = score_maps([estimate for estimate, _ in predicted], sample.truth)
            for task, (estimate, seconds), scores in zip(plain, predicted, rows, strict=True):
                more = self._more(task, number, sample, estimate)
                yield _result(task, sample, seconds, scores | more)
        for task in to_light:
            if task.control:
                estimate, seconds = self._predict(task, sample)
                yield _result(task, sample, seconds, score_spoiled(estimate, sample.truth))
        if sample.reflectance is not None:
            for task in to_reflectance:
                estimate, seconds = self._predict(task, sample)
                scores = score_reflectance(estimate, sample.reflectance)
                yield _result(task, sample, seconds, scores)

    def _predict(self, task: _Task, sample: StereoSample) -> tuple[NDArray[np.float32], float]:
        given = task.spoil(sample, self._samples) if task.spoil else sample
        started = time.perf_counter()
        estimate = task.predictor.predict(given)
        return estimate, time.perf_counter() - started

    def _more(
        self, task: _Task, number: int, sample: StereoSample, estimate: NDArray[np.float32]
    ) -> dict[str, float]:
        """What is scored for some samples only; and the prediction, kept."""
        scores: dict[str, float] = {}
        if self._training is not None:
            scores[TO_TRUTH] = log_distance(estimate, sample.truth)
            scores[TO_MEMORY] = self._training.distance(estimate)
        if number < self._settings.keep:
            self._kept.add_sample(sample)
            self._kept.add_prediction(task.predictor.digest, sample.key, estimate)
        if number < self._settings.protocol_count and self._settings.protocol:
            scores |= published_scores(estimate, sample.truth, self._settings.protocol)
        return scores


def _result(
    task: _Task, sample: StereoSample, seconds: float, scores: Mapping[str, float]
) -> Result:
    probe = sample.meta["probe"]
    return Result(
        predictor=task.predictor.name,
        key=sample.key,
        place=probe["place"],
        category=probe["category"],
        seconds=round(seconds, 5),
        scores={name: round(value, 6) for name, value in scores.items()},
        digest=task.predictor.digest,
        control=task.control,
    )


def read_results(out: Path) -> list[Result]:
    """The lines of results.jsonl, in order; a last line that was cut off is left out.

    Raises:
        StorageError: If the file cannot be read.
        RecordError: If another line is damaged.
    """
    path = out / RESULTS
    if not path.is_file():
        return []
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise storage_error("read", path, error) from error
    results = []
    for number, line in enumerate(lines, start=1):
        try:
            results.append(Result.from_json(json.loads(line)))
        except (json.JSONDecodeError, TypeError, KeyError, AttributeError) as error:
            if number == len(lines):
                break
            raise RecordError(
                f"{path}, line {number} is damaged ({error!r}). Delete the line and run `panokit "
                "evaluate` again: it scores what is missing.",
                reason="damaged-record",
            ) from error
    return results


def summaries(results: Iterable[Result], figure: str) -> dict[str, Summary]:
    """Of each predictor the summary of one figure; intervals are bootstrapped over samples."""
    by_name: dict[str, list[float]] = {}
    for result in results:
        if not result.control and figure in result.scores:
            by_name.setdefault(result.predictor, []).append(result.scores[figure])
    return {name: summarize(values) for name, values in by_name.items()}


def memorization(results: Iterable[Result]) -> dict[str, float]:
    """Of each predictor the share of predictions nearer to a training map than to the truth.

    A network that selects from memory comes near 1; one that reads the light stays low.
    """
    nearer: dict[str, list[bool]] = {}
    for result in results:
        if not result.control and TO_MEMORY in result.scores:
            closer = result.scores[TO_MEMORY] < result.scores[TO_TRUTH]
            nearer.setdefault(result.predictor, []).append(closer)
    return {name: float(np.mean(values)) for name, values in nearer.items()}

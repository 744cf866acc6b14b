"""Score predictors on a dataset: one line of results.jsonl for each predictor and sample.

What was scored is not scored again, so a run that was stopped goes on, and a model that is
added later costs only itself. All tables and figures are made from these lines.
"""

import json
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from panokit.errors import StorageError, UsageError
from panokit.evaluate.lighting.predictors import LightingPredictor
from panokit.evaluate.lighting.sample import StereoSample
from panokit.evaluate.lighting.scoring import score_map
from panokit.io.files import storage_error, write_bytes
from panokit.metrics.statistics import Summary, summarize

RESULTS = "results.jsonl"


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """One prediction's figures.

    Attributes:
        predictor: Who predicted.
        key: Of the sample.
        place: Where the light is from.
        category: The kind of scene, "" where it is not known.
        seconds: That the prediction took.
        scores: By the protocols' names.
    """

    predictor: str
    key: str
    place: str
    category: str
    seconds: float
    scores: Mapping[str, float]

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {name: getattr(self, name) for name in self.__slots__}


def evaluate_lighting(
    predictors: Sequence[LightingPredictor], samples: Iterable[StereoSample], out: Path
) -> list[Result]:
    """Score each predictor on each sample.

    Args:
        predictors: With names of their own.
        samples: In any order; each is read once.
        out: Gets results.jsonl; what is there counts as done.

    Returns:
        All results, those of earlier runs too.

    Raises:
        UsageError: If two predictors have one name.
        StorageError: If the file cannot be written.
    """
    names = [predictor.name for predictor in predictors]
    if len(set(names)) < len(names):
        raise UsageError(f"Two predictors have one name: {', '.join(names)}.")
    results = read_results(out)
    done = {(result.predictor, result.key) for result in results}
    path = out / RESULTS
    try:
        out.mkdir(parents=True, exist_ok=True)
        # Without a last line that was cut off: the next one would go on in it.
        write_bytes(path, "".join(json.dumps(r.to_json()) + "\n" for r in results).encode())
        with path.open("a", encoding="utf-8") as file:
            for result in _missing(predictors, samples, done):
                file.write(json.dumps(result.to_json()) + "\n")
                file.flush()
                results.append(result)
    except OSError as error:
        raise storage_error("write", path, error) from error
    return results


def _missing(
    predictors: Sequence[LightingPredictor],
    samples: Iterable[StereoSample],
    done: set[tuple[str, str]],
) -> Iterator[Result]:
    for sample in samples:
        for predictor in predictors:
            if (predictor.name, sample.key) in done:
                continue
            started = time.perf_counter()
            estimate = predictor.predict(sample)
            seconds = time.perf_counter() - started
            yield Result(
                predictor=predictor.name,
                key=sample.key,
                place=sample.meta["probe"]["place"],
                category=sample.meta["probe"]["category"],
                seconds=round(seconds, 5),
                scores={
                    name: round(value, 6)
                    for name, value in score_map(estimate, sample.truth).items()
                },
            )


def read_results(out: Path) -> list[Result]:
    """The lines of results.jsonl, in order; a last line that was cut off is left out."""
    path = out / RESULTS
    if not path.is_file():
        return []
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise StorageError(f"Cannot read {path}: {error.strerror}.") from error
    results = []
    for line in lines:
        try:
            results.append(Result(**json.loads(line)))
        except (json.JSONDecodeError, TypeError):
            continue
    return results


def summaries(results: Iterable[Result], figure: str) -> dict[str, Summary]:
    """Of each predictor the summary of one figure; intervals are bootstrapped over samples."""
    by_name: dict[str, list[float]] = {}
    for result in results:
        by_name.setdefault(result.predictor, []).append(result.scores[figure])
    return {name: summarize(values) for name, values in by_name.items()}


def memorization(estimates: np.ndarray, truths: np.ndarray, training: np.ndarray) -> float:
    """How much nearer predictions are to a training map than to their truth: 0 to 1.

    The share of predictions whose nearest training map, by mean squared difference of logs, is
    nearer than the truth. A network that selects from memory comes near 1.

    Args:
        estimates: (N, 64, 64, 3).
        truths: (N, 64, 64, 3).
        training: (M, 64, 64, 3).
    """
    logs = [np.log(np.maximum(maps, 1e-3)).reshape(len(maps), -1)
            for maps in (estimates, truths, training)]  # fmt: skip
    guess, true, known = logs
    to_truth = ((guess - true) ** 2).mean(axis=1)
    to_memory = np.array([((known - one) ** 2).mean(axis=1).min() for one in guess])
    return float((to_memory < to_truth).mean())

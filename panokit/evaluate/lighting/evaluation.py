"""`panokit evaluate`: models and baselines on a dataset, and all that figures need, in one folder.

OUT/results.jsonl   a line for each predictor and sample (and control)
OUT/history.jsonl   a line for each model and epoch
OUT/models.jsonl    a line for each model: what it is, how it was trained, how fast it is
OUT/dataset.json    the splits and their light
OUT/kept/           pictures and predictions of a few samples
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panokit.console import Console
from panokit.dataset.storage.read import StereoDataset
from panokit.errors import ModelError, RecordError
from panokit.evaluate.lighting.baselines import TrainingMaps
from panokit.evaluate.lighting.dataset_facts import describe_dataset
from panokit.evaluate.lighting.models import ModelFacts, find_models
from panokit.evaluate.lighting.predictors import LightingPredictor, NetworkPredictor, baselines
from panokit.evaluate.lighting.run import Result, evaluate_lighting
from panokit.evaluate.lighting.sample import Samples
from panokit.evaluate.lighting.settings import LightingEvaluation
from panokit.evaluate.lighting.speed import measure_speed
from panokit.io.files import read_bytes, write_bytes, write_json

HISTORY, MODELS, DATASET = "history.jsonl", "models.jsonl", "dataset.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class Evaluation:
    """What was judged.

    Attributes:
        models: That were named.
        results: All of the folder, those of earlier runs too.
        seen: Model -> places of the test that it was trained on; None where it does not say.
    """

    models: tuple[ModelFacts, ...]
    results: list[Result]
    seen: Mapping[str, list[str] | None]


def evaluate(
    named: Sequence[str],
    data: Path,
    out: Path,
    *,
    split: str = "test",
    with_baselines: bool = True,
    with_speed: bool = True,
    settings: LightingEvaluation | None = None,
    console: Console | None = None,
) -> Evaluation:
    """Judge models on a split of a dataset; what is done already is not done again.

    Args:
        named: Folders of models, folders of such folders, or ids of released models.
        data: The dataset.
        out: For everything that figures are made from.
        split: Of the dataset.
        with_baselines: Whether the baselines are judged, too.
        with_speed: Whether latency and memory are measured, once for each architecture.
        settings: How.
        console: For progress.

    Raises:
        ModelError: If a name stands for no model.
        UsageError: If the split is empty.
        StorageError: If something cannot be read or written.
    """
    settings = settings or LightingEvaluation()
    console = console or Console(quiet=True)
    models, judged = _predictors(named, console)
    samples = Samples(data, split, settings.count)
    _tell_of_enlarging(models, samples[0].views.mask.shape[1], console)
    description = describe_dataset(data, split)
    write_json(out / DATASET, description)
    write_history(out, models)
    test_places = description["splits"][split]["places"]
    seen = {facts.name: facts.seen(test_places) for facts in models}
    write_models(out, models, seen)
    training = _training_maps(data, settings.training_maps, console)
    if with_baselines:
        judged += baselines(training)
    with console.stage("evaluate", len(samples), unit="samples") as tick:
        results = evaluate_lighting(
            judged, samples, out, settings=settings, training=training, tick=tick
        )
    if with_speed:
        _measure(out, models, console)
    return Evaluation(models=tuple(models), results=results, seen=seen)


def _predictors(
    named: Sequence[str], console: Console
) -> tuple[list[ModelFacts], list[LightingPredictor]]:
    """The models that can be run. One in a folder of many that cannot is told of and left out."""
    models: list[ModelFacts] = []
    judged: list[LightingPredictor] = []
    alone = {Path(name).resolve() for name in named}
    for facts in find_models(named):
        try:
            judged.append(NetworkPredictor(facts))
            models.append(facts)
        except ModelError as error:
            if facts.folder.resolve() in alone:
                raise
            console.note(f"{facts.name} is left out: {error}")
    return models, judged


def _tell_of_enlarging(models: Sequence[ModelFacts], width_px: int, console: Console) -> None:
    for facts in models:
        if facts.input_px > width_px:
            console.note(
                f"{facts.name} reads {facts.input_px} pixels and the pictures have {width_px}: "
                "they are enlarged, and its figures are of blurred pictures."
            )


def _training_maps(data: Path, most: int, console: Console) -> TrainingMaps:
    """Maps of the training split, evenly over it."""
    dataset = StereoDataset(data, "train", members=("env64.exr",))
    step = max(1, -(-len(dataset) // most))
    numbers = range(0, len(dataset), step)
    maps = []
    with console.stage("training maps", len(numbers)) as tick:
        for number in numbers:
            maps.append(dataset.decoded(number, "env64.exr"))
            tick()
    return TrainingMaps(maps, most)


def write_history(out: Path, models: Sequence[ModelFacts]) -> None:
    """Write history.jsonl: the lines of these models are new, others stay."""
    names = {facts.name for facts in models}
    lines = [line for line in read_lines(out / HISTORY) if line["model"] not in names]
    for facts in models:
        lines += [
            {"model": facts.name, "experiment": facts.experiment, "size": facts.size,
             "seed": facts.seed, "converged": facts.converged, "epoch": number, **epoch}
            for number, epoch in enumerate(facts.history, start=1)
        ]  # fmt: skip
    write_lines(out / HISTORY, lines)


def write_models(
    out: Path, models: Sequence[ModelFacts], seen: Mapping[str, list[str] | None]
) -> None:
    """Write models.jsonl: the lines of these models are new, their measured speed stays."""
    known = {line["name"]: line for line in read_lines(out / MODELS)}
    for facts in models:
        before = known.get(facts.name, {})
        speed = before.get("speed") if before.get("digest") == facts.digest else None
        known[facts.name] = {**facts.to_json(), "seen": seen[facts.name], "speed": speed}
    write_lines(out / MODELS, [known[name] for name in sorted(known)])


def _measure(out: Path, models: Sequence[ModelFacts], console: Console) -> None:
    """Add latency and memory to models.jsonl, for one seed of each experiment."""
    known = {line["name"]: line for line in read_lines(out / MODELS)}
    measured = {(line["experiment"], line["size"]) for line in known.values() if line["speed"]}
    first: dict[tuple[str, str], ModelFacts] = {}
    for facts in sorted(models, key=lambda one: one.seed):
        first.setdefault((facts.experiment, facts.size), facts)
    left = [facts for what, facts in first.items() if what not in measured]
    with console.stage("speed", len(left)) as tick:
        for facts in left:
            known[facts.name]["speed"] = measure_speed(facts).to_json()
            write_lines(out / MODELS, [known[name] for name in sorted(known)])
            tick()


def read_lines(path: Path) -> list[dict[str, Any]]:
    """The records of a .jsonl file; none if there is no file.

    Raises:
        RecordError: If a line is no record.
    """
    if not path.is_file():
        return []
    try:
        return [json.loads(line) for line in read_bytes(path).decode().splitlines()]
    except ValueError as error:
        raise RecordError(
            f"{path} is damaged ({error}). Delete it and run `panokit evaluate` again.",
            reason="damaged-record",
        ) from error


def write_lines(path: Path, records: Sequence[Mapping[str, Any]]) -> None:
    """Write a .jsonl file."""
    write_bytes(path, "".join(json.dumps(record) + "\n" for record in records).encode())

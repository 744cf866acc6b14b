"""From probes to models: for each arm of a pipeline a dataset, and a model trained on it.

The arm "references" is lit by maps of true range alone, the arm "augmented" by the run's own
probes, too. Both have the same objects, numbers of samples and seeds, and one seed splits the
places of both, so that what the first arm holds out the second does not learn from.
"""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from panokit.console import Console
from panokit.dataset.production.settings import ProductionSettings
from panokit.dataset.settings import VERSION as DATASET_VERSION
from panokit.errors import UsageError
from panokit.io.files import storage_error
from panokit.io.pictures import record_path
from panokit.pipeline.batch import BatchResult
from panokit.pipeline.once import do_once, folder_of
from panokit.pipeline.settings import Arm, DatasetStage, PipelineSettings
from panokit.provenance import digest_of
from panokit.records import Receipt, RunFolder, stage_key

if TYPE_CHECKING:
    from panokit.dataset.production.library_maker import LibraryMaker
    from panokit.train.stereo.recipe import LightingRecipe

TRAIN_VERSION = "1"


def render_arms(
    settings: PipelineSettings,
    run: RunFolder,
    console: Console,
    references: Receipt,
    probes: Sequence[Receipt],
) -> BatchResult:
    """Render the datasets of all arms, or what is missing of them.

    Args:
        settings: Of the pipeline.
        run: The run.
        console: Says how it goes.
        references: The maps of true range.
        probes: The run's maps that passed.

    Raises:
        UsageError: If a place that one arm holds out would be learned from in another.
    """
    asked = _asked(settings)
    receipts = []
    for arm in asked.arms:
        inputs = [references.key, *(_identity(probe) for probe in _own(arm, probes))]
        content = asked.model_dump(mode="json", exclude={"arms"})
        key = stage_key("dataset", DATASET_VERSION, digest_of(content), [arm, *inputs])
        folder = folder_of(run.models, f"dataset-{arm}", key)

        def work(arm: Arm = arm, folder: Path = folder) -> Mapping[str, Any]:
            # Here, because a run that is finished needs none of it.
            from panokit.dataset.production.library_maker import open_maker
            from panokit.dataset.production.produce import render_dataset
            from panokit.dataset.storage.layout import DatasetFolder

            lights = [references.path]
            if arm == "augmented":
                lights.append(_lights(folder.with_name(f"{folder.name}-lights"), probes))
            maker = open_maker(asked.settings, lights, packed=DatasetFolder(folder).lights)
            if arm == "augmented":
                _check_held_out(asked, references.path, maker)
            console.note(f"dataset: {arm}, lit by {len(maker.stock.lights.all)} maps")
            made = render_dataset(maker, folder, _production(settings, asked), console)
            return {
                "samples": made.samples,
                "missing": len(made.missing),
                "lights": {s: len(ids) for s, ids in maker.stock.lights_of.items()},
            }

        receipts.append(do_once("dataset", arm, folder, key, work))
    return BatchResult(stage="dataset", receipts=tuple(receipts))


def train_arms(
    settings: PipelineSettings, run: RunFolder, console: Console, datasets: Sequence[Receipt]
) -> BatchResult:
    """Train a model on each arm's dataset, or what is missing of it.

    Raises:
        MissingExtraError: If torch is not installed.
    """
    recipe = settings.train
    if recipe is None:
        raise UsageError("This pipeline has no table train.")
    receipts = []
    for dataset in datasets:
        own = recipe.model_copy(update={"id": f"{recipe.id}-{dataset.item}"})
        key = stage_key("train", TRAIN_VERSION, own.digest, [dataset.key])
        folder = folder_of(run.models, own.id, key)

        def work(
            own: "LightingRecipe" = own, dataset: Receipt = dataset, folder: Path = folder
        ) -> Mapping[str, Any]:
            from panokit.train.stereo.stage import train_model  # torch

            console.note(f"train: {own.id}, {own.schedule.epochs} epochs")
            # Packs and checkpoints lie apart: a stopped training goes on from there.
            with console.stage(f"train {dataset.item}", 1) as tick:
                train_model(own, dataset.path, folder.with_name(f"{folder.name}-work"), folder)
                tick()
            return {"model": own.id}

        receipts.append(do_once("train", dataset.item, folder, key, work))
    return BatchResult(stage="train", receipts=tuple(receipts))


def _asked(settings: PipelineSettings) -> DatasetStage:
    if settings.dataset is None:
        raise UsageError("This pipeline has no table dataset.")
    return settings.dataset


def _production(settings: PipelineSettings, asked: DatasetStage) -> ProductionSettings:
    return ProductionSettings(
        count=asked.count,
        shard_samples=asked.shard_samples,
        engine=settings.engine,
        workers=settings.workers,
        cluster=settings.cluster,
    )


def _own(arm: Arm, probes: Sequence[Receipt]) -> Sequence[Receipt]:
    return probes if arm == "augmented" else ()


def _identity(probe: Receipt) -> str:
    """What a probe is: its item and the id that the library gave it, which goes by content."""
    return f"{probe.item}:{probe.key}"


def _lights(folder: Path, probes: Sequence[Receipt]) -> Path:
    """A folder of links to the maps that passed, each with its record."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        wanted = {}
        for probe in probes:
            for file, suffix in ((probe.path, ".exr"), (record_path(probe.path), ".json")):
                wanted[f"{probe.item}{suffix}"] = file
        for there in folder.iterdir():
            if there.name not in wanted:
                there.unlink()
        for name, file in wanted.items():
            link = folder / name
            if not link.exists():
                link.unlink(missing_ok=True)
                link.symlink_to(os.path.relpath(file, folder))
    except OSError as error:
        raise storage_error("link maps in", folder, error) from error
    return folder


def _check_held_out(asked: DatasetStage, references: Path, augmented: "LibraryMaker") -> None:
    """That no map which the arm of references holds out for the test is learned from."""
    from panokit.dataset.production.library_maker import open_maker

    held_out = open_maker(asked.settings, [references]).stock.lights_of["test"]
    tested = set(augmented.stock.lights_of["test"])
    leaked = sorted(set(held_out) - tested)
    if leaked:
        raise UsageError(
            f"The reference map {leaked[0]} is held out for the test, but the augmented arm would "
            "learn from its place: a probe was fetched there, or there are too few maps to split. "
            "Fetch elsewhere, give more reference maps, or another dataset.settings.seed."
        )

"""`panokit train` for lighting: a recipe and a dataset in, a model out; or a suite of them."""

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import nn

from panokit.dataset.storage.index import indexed_digest
from panokit.engine import Engine, LocalEngine, Outcome
from panokit.errors import ModelError, Rejection, StorageError, UsageError
from panokit.io.files import read_json, write_json
from panokit.provenance import digest_of
from panokit.records import Receipt
from panokit.train.history import FILE as HISTORY
from panokit.train.stereo.loop import has_converged, train_lighting
from panokit.train.stereo.pack import Pack, join_packs, open_pack
from panokit.train.stereo.recipe import LightingRecipe, read_lighting_recipe
from panokit.train.stereo.release import release_lighting
from panokit.train.stereo.sizes import at_size, read_size
from panokit.train.team import ALONE, Team

SUMMARY = "training.json"
STAGE = "train"


@dataclass(frozen=True, slots=True, kw_only=True)
class Training:
    """One network of a suite.

    Attributes:
        experiment: The recipe's id, without size and seed.
        recipe: What is trained.
        dataset: The folder of a stereo dataset.
        work: For packs, checkpoints and the history.
        folder: The model's.
    """

    experiment: str
    recipe: LightingRecipe
    dataset: Path
    work: Path
    folder: Path

    @property
    def item(self) -> str:
        """What engines call it."""
        return self.recipe.id

    @property
    def stage(self) -> str:
        """What engines say is done."""
        return STAGE


def plan_suite(
    recipes: Sequence[Path], size: str, dataset: Path, work: Path, out: Path
) -> list[Training]:
    """The networks of a suite: all recipes with the first seed, then all with the next.

    Args:
        recipes: TOML files, or folders of them.
        size: See `panokit.train.stereo.sizes.read_size`.
        dataset: The folder of a stereo dataset.
        work: For packs, checkpoints and histories.
        out: Gets a folder for each model.

    Raises:
        UsageError: If a folder holds no recipe, or two recipes have one id.
    """
    files: list[Path] = []
    for recipe in recipes:
        found = sorted(recipe.glob("*.toml")) if recipe.is_dir() else [recipe]
        if not found:
            raise UsageError(f"There are no recipes in {recipe}.")
        files += found
    ids = {file: read_lighting_recipe(file).id for file in files}
    often, count = Counter(ids.values()).most_common(1)[0]
    if count > 1:
        raise UsageError(f"{count} recipes are called {often!r}. Give each an id of its own.")
    return [
        Training(
            experiment=ids[file],
            recipe=(made := at_size(file, size, seed)),
            dataset=dataset,
            work=work,
            folder=out / made.id,
        )
        for seed in range(read_size(size).seeds)
        for file in ids
    ]


def train_suite(trainings: Sequence[Training], engine: Engine | None = None) -> list[Outcome]:
    """Train them all, several at a time; those that are done are left as they are.

    A network of this size gains little from a second core, so each has one.

    Args:
        trainings: See `plan_suite`.
        engine: That runs them; one network per core if not given.

    Returns:
        A receipt for each network, or a rejection that says why there is none.
    """
    # Before the workers come, which would make the same packs side by side.
    ready, rejections = _with_samples(trainings)
    return [*(engine or LocalEngine()).run(train_one, ready), *rejections]


def train_one(training: Training) -> Outcome:
    """Train one network of a suite, if that is not done yet.

    What goes wrong with it does not end the suite: other networks may do better.
    """
    recipe = training.recipe
    try:
        fresh = not _is_done(training)
        if fresh:
            train_model(
                recipe, training.dataset, training.work, training.folder,
                experiment=training.experiment,
            )  # fmt: skip
    except ModelError as error:
        return Rejection(item=recipe.id, stage=STAGE, reason="no-model", message=str(error))
    return _receipt(training, fresh)


def train_together(trainings: Sequence[Training], team: Team) -> list[Outcome]:
    """Train one network after the other, each by the whole team: for graphics processors.

    Raises:
        ModelError: If a network diverges.
    """
    receipts: list[Outcome] = []
    # The first process makes the packs that the others then find.
    if not team.leads:
        team.wait()
    ready, rejections = _with_samples(trainings)
    if team.leads:
        team.wait()
    for training in ready:
        fresh = not _is_done(training)
        # Nobody may begin and write what others have not looked for yet.
        team.wait()
        if fresh:
            train_model(
                training.recipe, training.dataset, training.work, training.folder,
                team=team, experiment=training.experiment,
            )  # fmt: skip
        receipts.append(_receipt(training, fresh))
    return [*receipts, *rejections]


def _with_samples(trainings: Sequence[Training]) -> tuple[list[Training], list[Outcome]]:
    """Those whose packs are there now, and rejections of those whose own sources are not."""
    ready: list[Training] = []
    rejections: list[Outcome] = []
    for training in trainings:
        recipe = training.recipe
        try:
            open_packs(recipe, training.dataset, training.work)
        except (UsageError, StorageError) as error:
            if not recipe.sources:
                raise
            rejections.append(
                Rejection(item=recipe.id, stage=STAGE, reason="no-samples", message=str(error))
            )
        else:
            ready.append(training)
    return ready, rejections


def _is_done(training: Training) -> bool:
    """Whether the model is there, made by this recipe from this dataset."""
    path = training.folder / SUMMARY
    if not path.is_file():
        return False
    record, samples = read_json(path), _samples_digest(training.recipe, training.dataset)
    made_by, made_from = record.get("recipe"), record.get("dataset", samples)
    return bool(made_by == training.recipe.digest and made_from == samples)


def _samples_digest(recipe: LightingRecipe, dataset: Path) -> str:
    """A digest of all datasets that a recipe takes samples from."""
    own = indexed_digest(dataset)
    if not recipe.sources:
        return own
    return digest_of([own, *(indexed_digest(dataset / one.data) for one in recipe.sources)])


def _receipt(training: Training, fresh: bool) -> Receipt:
    recipe = training.recipe
    return Receipt(
        item=recipe.id, stage=STAGE, path=training.folder, key=recipe.digest, fresh=fresh
    )


def train_model(
    recipe: LightingRecipe,
    dataset: Path,
    work: Path,
    folder: Path,
    *,
    team: Team = ALONE,
    experiment: str = "",
) -> None:
    """Train one recipe and write the model and `training.json` to its folder.

    Args:
        recipe: What and how.
        dataset: The folder of a stereo dataset.
        work: For packs, checkpoints and the history; a run that was stopped goes on from there.
        folder: The model's.
        team: That trains it; its first process writes.
        experiment: What the recipe is called without size and seed.
    """
    if team.leads:
        open_packs(recipe, dataset, work)
    team.wait()
    training, validation = open_packs(recipe, dataset, work)
    source = _samples_digest(recipe, dataset)
    place = work / "lighting" / f"{recipe.id}-{digest_of([recipe.digest, source])[:12]}"
    network = train_lighting(recipe, training, validation, place, team=team)
    if team.leads:
        release_lighting(recipe, network, folder)
        origin = {"experiment": experiment or recipe.id, "dataset": source}
        write_json(folder / SUMMARY, origin | _summary(recipe, place, training, network))
    team.wait()


def open_packs(recipe: LightingRecipe, dataset: Path, work: Path) -> tuple[Pack, Pack]:
    """What a recipe learns from and what it is validated on; made if they are not there.

    Raises:
        UsageError: If a split is empty, or no sample is from the recipe's sources.
    """
    size = recipe.network.input_px
    validation = open_pack(dataset, "validation", size, work)
    if not recipe.sources:
        return open_pack(dataset, "train", size, work, recipe.samples), validation
    parts = []
    for source in recipe.sources:
        pack = open_pack((dataset / source.data).resolve(), "train", size, work)
        usable = np.isin(pack.places, source.places) if source.places else np.full(len(pack), True)
        chosen = np.flatnonzero(usable)
        parts.append((pack, chosen[: source.samples] if source.samples else chosen))
    return join_packs(parts, work), validation


def _summary(
    recipe: LightingRecipe, place: Path, training: Pack, network: nn.Module
) -> dict[str, object]:
    """What the training was, for cards and verdicts."""
    lines = [json.loads(line) for line in (place / HISTORY).read_text("utf-8").splitlines()]
    validation = [float(line["validation"]) for line in lines]
    return {
        "schema": "panokit.lighting-training/1",
        "recipe": recipe.digest,
        "seed": recipe.seed,
        "kind": recipe.kind,
        "samples": len(training),
        "places": sorted({str(one) for one in training.places}),
        "input_px": recipe.network.input_px,
        "parameters": sum(weights.numel() for weights in network.parameters()),
        "steps": lines[-1]["step"],
        "epochs": len(lines),
        "cpu_hours": round(sum(float(line["cpu_s"]) for line in lines) / 3600, 6),
        "torch": str(torch.__version__),
        "converged": has_converged(validation),
        "history": [
            {name: line[name] for name in ("step", "loss", "validation", "ssd")} for line in lines
        ],
    }

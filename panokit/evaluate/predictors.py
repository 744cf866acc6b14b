"""What can be judged: anything that takes a clipped picture and gives radiance.

A `Method` is a column of the table. Its predictor may differ from fold to fold: a rule that is
fitted to the other folds, or a network for each fold.
"""

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ModelError, UsageError
from panokit.evaluate.probe_set import ListedProbe
from panokit.expand.baselines import AreaRule, expand_area, expand_reinhard, expand_srgb
from panokit.expand.network import ExpansionNetwork, compose, predict
from panokit.expand.reduce import ReducedPanorama, reduce_panorama
from panokit.expand.settings import VERSION as EXPAND_VERSION
from panokit.io.files import read_bytes
from panokit.provenance import digest_of
from panokit.weights import ReleasedModel, find_model, read_model

TRAINING_RECORD = "training.json"
# Stands for the number of the fold in a path; and what a method with one model for each is called.
_MOST_FOLDS = 100
FOLD, PER_FOLD = "{fold}", " (per fold)"


class Predictor(Protocol):
    """Turns a picture into radiance."""

    @property
    def digest(self) -> str:
        """Equal digests promise equal answers."""
        ...

    def predict(self, pixels: NDArray[np.uint8]) -> NDArray[np.float32]:
        """Linear radiance (H, W, 3) of any scale, for a picture (H, W, 3) uint8, sRGB."""
        ...

    def has_seen(self, probe: ListedProbe) -> bool | None:
        """Whether it was trained on this probe; None if nobody says."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Method:
    """A column of the table.

    Attributes:
        name: Its heading.
        predictor: The one that judges the probes of a fold.
        has_fold: Whether there is one for a fold; the probes of others are left out.
    """

    name: str
    predictor: Callable[[int], Predictor]
    has_fold: Callable[[int], bool] = lambda fold: True


@dataclass(frozen=True, slots=True, kw_only=True)
class AnalyticPredictor:
    """A formula; it was trained on nothing.

    Attributes:
        digest: Of the formula and its numbers.
        formula: From the reduced picture to radiance.
    """

    digest: str
    formula: Callable[[ReducedPanorama], NDArray[np.float32]]

    def predict(self, pixels: NDArray[np.uint8]) -> NDArray[np.float32]:
        """See `Predictor`."""
        return self.formula(reduce_panorama(pixels, pixels.shape[1]))

    def has_seen(self, probe: ListedProbe) -> bool | None:
        """Never."""
        return False


def ldr_values(reduced: ReducedPanorama) -> NDArray[np.float32]:
    """The picture's code values taken for radiance: what a user without panokit has."""
    return reduced.encoded


def analytic_methods() -> list[Method]:
    """LDR, sRGB and inverse Reinhard; the area rule is `area_method`."""
    formulas = {"LDR": ldr_values, "sRGB": expand_srgb, "inverse Reinhard": expand_reinhard}
    return [_analytic(name, formula) for name, formula in formulas.items()]


def area_method(rules: dict[int, AreaRule]) -> Method:
    """The saturated-area rule, with the numbers that the other folds give for each fold."""

    def predictor(fold: int) -> Predictor:
        rule = rules[fold]
        return AnalyticPredictor(
            digest=digest_of(["area", rule.offset, rule.slope]),
            formula=lambda reduced: expand_area(reduced, rule),
        )

    return Method(name="area rule", predictor=predictor)


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelPredictor:
    """A model of panokit's own kind.

    Attributes:
        model: As its folder describes it.
        network: Loaded.
        seen: SHA-256 of the probes that it was trained on; None if they are not listed.
        unseen_by_fold: Whether the user gave a model for each fold.
    """

    model: ReleasedModel
    network: ExpansionNetwork
    seen: frozenset[str] | None
    unseen_by_fold: bool = False

    @property
    def digest(self) -> str:
        """Of the weights, and of the stage that runs them."""
        return digest_of([EXPAND_VERSION, self.network.digest])

    def predict(self, pixels: NDArray[np.uint8]) -> NDArray[np.float32]:
        """See `Predictor`."""
        reduced = reduce_panorama(pixels, pixels.shape[1])
        return compose(reduced, predict(reduced, self.network))

    def has_seen(self, probe: ListedProbe) -> bool | None:
        """By the model's training.json; else a model for each fold is taken at its word, and a
        recipe trains on all usable probes.
        """  # noqa: D205
        if self.seen is not None:
            return probe.sha256 in self.seen
        if self.unseen_by_fold:
            return False
        return True if (self.model.folder / "recipe.toml").is_file() else None


def model_method(where: str) -> Method:
    """A released model by its id, or a model's folder, or a pattern with {fold} for one each.

    Raises:
        ModelError: If there is none, or its files are damaged.
    """

    @lru_cache(maxsize=16)
    def load(place: str) -> ModelPredictor:
        folder = Path(place)
        model = read_model(folder) if (folder / "model.toml").is_file() else find_model(place)
        return ModelPredictor(
            model=model,
            network=ExpansionNetwork(model, threads=1, device="cpu"),
            seen=seen_digests(model.folder),
            unseen_by_fold=FOLD in where,
        )

    first = load(first_of(where, "model.toml"))
    return Method(
        name=first.model.id + (PER_FOLD if FOLD in where else ""),
        predictor=lambda fold: load(where.replace(FOLD, str(fold))),
        has_fold=partial(is_for_fold, where, "model.toml"),
    )


def is_for_fold(pattern: str, file: str, fold: int) -> bool:
    """Whether there is a model for a fold; without {fold} in the pattern it is for all.

    Args:
        pattern: A path, with {fold} for the number of the fold or without.
        file: That must lie at the path; "" if the path is the file.
        fold: The number.
    """
    return FOLD not in pattern or Path(pattern.replace(FOLD, str(fold)), file).is_file()


def first_of(pattern: str, file: str) -> str:
    """The path of the first fold for which there is a model, see `is_for_fold`; the pattern
    itself if it is no pattern.

    Raises:
        UsageError: If there is none.
    """  # noqa: D205
    for fold in range(_MOST_FOLDS):
        if is_for_fold(pattern, file, fold):
            return pattern.replace(FOLD, str(fold))
    raise UsageError(
        f"There is no model for any fold at {pattern}. Train them with: panokit train --folds"
    )


def seen_digests(folder: Path) -> frozenset[str] | None:
    """The probes that a training.json in a folder lists, by SHA-256; None without one.

    Raises:
        ModelError: If it is damaged.
    """
    path = folder / TRAINING_RECORD
    if not path.is_file():
        return None
    try:
        return frozenset(json.loads(read_bytes(path))["seen"].values())
    except (ValueError, KeyError, AttributeError, TypeError) as error:
        raise ModelError(
            f"{path} does not say what was seen in training ({error}). Train again."
        ) from error


def check_names(methods: list[Method]) -> None:
    """Check that no two methods share a heading.

    Raises:
        UsageError: If they do.
    """
    names = [method.name for method in methods]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise UsageError(f"Two methods are called {', '.join(twice)}. Give each another name.")


def file_digest(path: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(read_bytes(path)).hexdigest()


def _analytic(name: str, formula: Callable[[ReducedPanorama], NDArray[np.float32]]) -> Method:
    predictor = AnalyticPredictor(digest=digest_of(["analytic", name]), formula=formula)
    return Method(name=name, predictor=lambda fold: predictor)

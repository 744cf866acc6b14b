"""The expansion experiment: a recipe against analytic methods, on probes it has not seen.

Whole groups of probes are held out, fold by fold. Each held-out probe is photographed with
the test cameras A and B; the recipe and the saturated-area rule know the other folds only.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.color.camera import CAMERA_A, CAMERA_B, photograph
from panokit.expand.baselines import AreaRule, expand_area, expand_reinhard, expand_srgb
from panokit.expand.network import ExpansionNetwork, compose, predict
from panokit.expand.reduce import ReducedPanorama, reduce_panorama
from panokit.metrics import ExpansionScore, score_expansion
from panokit.train.area_rule import fit_area_rule
from panokit.train.ensemble import train_ensemble
from panokit.train.examples import Examples
from panokit.train.probes import FOLDS, TrainingProbe, assign_folds
from panokit.train.recipe import Recipe
from panokit.train.release import release
from panokit.weights import read_model

TEST_CAMERAS = (CAMERA_A, CAMERA_B)
METHODS = ("ldr", "srgb", "reinhard", "area", "recipe")


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoreRow:
    """One method on one picture.

    Attributes:
        method: One of `METHODS`.
        camera: "A" or "B".
        probe: Its name.
        category: Of the probe.
        fold: That the probe was held out in.
        score: What came out.
    """

    method: str
    camera: str
    probe: str
    category: str
    fold: int
    score: ExpansionScore


def train_fold(
    probes: Sequence[TrainingProbe],
    examples: Examples,
    recipe: Recipe,
    fold: int,
    work: Path,
    *,
    component_examples: Examples | None = None,
) -> Path:
    """Train and export the recipe without the probes of one fold; returns the model's folder."""
    known = np.flatnonzero(assign_folds(probes, FOLDS) != fold)
    folder = work / f"fold-{fold}"
    own = None if component_examples is None else component_examples.of_probes(known)
    network = train_ensemble(examples.of_probes(known), recipe, folder, component_examples=own)
    release(recipe, network, folder)
    return folder


def judge_fold(
    probes: Sequence[TrainingProbe], examples: Examples, fold: int, model: Path
) -> list[ScoreRow]:
    """Score every method on the probes of one fold.

    Args:
        probes: All probes.
        examples: Of all probes; the area rule is fitted to those outside the fold.
        fold: To judge.
        model: The folder that `train_fold` returned.
    """
    folds = assign_folds(probes, FOLDS)
    rule = fit_area_rule(examples.of_probes(np.flatnonzero(folds != fold)))
    network = ExpansionNetwork(read_model(model), threads=1)
    rows = []
    for index in np.flatnonzero(folds == fold).tolist():
        probe = probes[index]
        radiance = probe.radiance()
        for camera in TEST_CAMERAS:
            # Far from the seeds of the training pictures.
            shot = photograph(radiance, camera, seed=1_000_000_000 + index)
            truth = radiance * np.float32(shot.exposure)
            reduced = reduce_panorama(shot.pixels, radiance.shape[1])
            rows += [
                ScoreRow(
                    method=method,
                    camera=camera.name,
                    probe=probe.name,
                    category=probe.category,
                    fold=fold,
                    score=score_expansion(estimate, truth, shot.pixels),
                )
                for method, estimate in _estimates(reduced, rule, network)
            ]
    return rows


def _estimates(
    reduced: ReducedPanorama, rule: AreaRule, network: ExpansionNetwork
) -> Iterator[tuple[str, NDArray[np.float32]]]:
    """The radiance that each of `METHODS` finds."""
    yield "ldr", reduced.encoded
    yield "srgb", expand_srgb(reduced)
    yield "reinhard", expand_reinhard(reduced)
    yield "area", expand_area(reduced, rule)
    yield "recipe", compose(reduced, predict(reduced, network))

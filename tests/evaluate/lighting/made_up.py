"""Evaluations that nobody ran: scores with known effects, in a folder as evaluators write it."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from panokit.evaluate.lighting.controls import CONTROLS, NORMALS
from panokit.evaluate.lighting.evaluation import DATASET, HISTORY, MODELS, write_lines
from panokit.evaluate.lighting.kept import Kept
from panokit.evaluate.lighting.published import ARRAY_PARTS, SPHERE_PARTS, SPHERES, name_of
from panokit.evaluate.lighting.run import RESULTS, TO_MEMORY, TO_TRUTH, Result
from panokit.evaluate.lighting.sample import StereoSample
from panokit.evaluate.lighting.scoring import DOMINANCE, FIGURES, ON_REFLECTANCE
from panokit.io.files import write_json

# Experiment -> how much its error is off 1, in the mean.
EFFECTS: Mapping[str, float] = {
    "concat-unshared-deep": 0.0, "concat-shared-deep": 0.001, "dot-product-deep": -0.05,
    "concat-shared": 0.02, "dot-product": -0.04, "no-background": 0.4,
    "background-branch": -0.2, "pyramid": -0.199, "pyramid-multi-scale": -0.21,
    "dematerial": -0.3, "dematerial-noise-10": -0.25, "dematerial-noise-20": -0.15,
    "dematerial-noise-30": -0.05, "panokit": -0.4,
}  # fmt: skip
REFLECTANCE: Mapping[str, float] = {
    "dense-reflectance": -0.2, "dense-reflectance-noise-10": 0.0,
    "dense-reflectance-noise-20": 0.1, "picture-reflectance": 0.05,
}  # fmt: skip
BASELINES: Mapping[str, float] = {
    "mean map": 0.5, "random map": 1.0, "nearest map (oracle)": -0.5, "ambient color": 0.7,
}  # fmt: skip
_SCALES = {"code-ssd": 60.0, "thesis-dssim": 0.3, "thesis-dssim-log": 0.1, "thesis-mse": 3.0,
           "light-vector": 30.0, "brightest": 40.0, "peak": 40.0}  # fmt: skip


def make_up(
    folder: Path,
    *,
    samples: int = 60,
    places: int = 6,
    seeds: int = 3,
    effects: Mapping[str, float] = EFFECTS,
    unfinished: tuple[str, ...] = (),
    seen: Mapping[str, list[str]] = {},
    kept: list[StereoSample] = (),
) -> Path:
    """Write results.jsonl, history.jsonl, models.jsonl, dataset.json and kept/ into a folder.

    Args:
        folder: For all of it.
        samples: Scored by everybody.
        places: That they are from.
        seeds: Of each experiment.
        effects: Of light experiments, see `EFFECTS`.
        unfinished: Models whose training had not converged.
        seen: Model -> places of the test that it was trained on.
        kept: Samples whose pictures and predictions are kept.
    """
    rng = np.random.default_rng(0)
    keys = [sample.key for sample in kept] + [f"{n:09d}" for n in range(900, 900 + samples)]
    keys = keys[:samples]
    hardness = rng.lognormal(0, 0.5, samples)
    dominance = rng.lognormal(0.8, 0.6, samples)
    lines, models, history = [], [], []

    def judged(name: str, effect: float, number: int, figures: tuple[str, ...], control: str = ""):
        own = np.random.default_rng([number, 7])
        for position, key in enumerate(keys):
            error = hardness[position] * (1 + effect) * own.lognormal(0, 0.05)
            scores = {one: error * _SCALES.get(one, 1.0) for one in figures}
            if figures is not ON_REFLECTANCE and not control:
                scores |= {DOMINANCE: dominance[position], TO_TRUTH: 0.3 * error,
                           TO_MEMORY: 0.3 * own.uniform(0.5, 1.5)}  # fmt: skip
                scores |= _published(error) if position < 8 else {}
            lines.append(Result(
                predictor=name, key=key, place=f"place {position % places}",
                category="sky_only" if position % 2 else "indoor_lamps", seconds=0.01,
                scores={one: round(float(value), 6) for one, value in scores.items()},
                digest=_digest(name), control=control,
            ).to_json())  # fmt: skip

    number = 0
    for experiment, effect in (*effects.items(), *REFLECTANCE.items()):
        figures = ON_REFLECTANCE if experiment in REFLECTANCE else FIGURES
        for seed in range(seeds):
            name, number = f"{experiment}-two-core-s{seed}", number + 1
            judged(name, effect, number, figures)
            kind = "picture-reflectance" if experiment.startswith("picture") else (
                "dense-reflectance" if experiment in REFLECTANCE else
                "dematerial" if experiment.startswith("dematerial") else "stereo")  # fmt: skip
            if kind == "stereo":
                for step, control in enumerate(CONTROLS):
                    judged(name, effect + 0.1 * step, number, ("code-ssd",), control)
            if experiment == "dematerial":
                for level, control in NORMALS.items():
                    judged(name, effect + 0.01 * level, number, ("code-ssd",), control)
            finished = name not in unfinished
            models.append(_model(name, experiment, kind, seed, finished, seen.get(name, [])))
            slow = 2.0 if experiment.startswith("concat") else 1.0
            history += _history(name, experiment, seed, 60 * (1 + effect), slow, finished)
    for name, effect in BASELINES.items():
        number += 1
        judged(name, effect, number, FIGURES)
    write_lines(folder / RESULTS, lines)
    write_lines(folder / MODELS, models)
    write_lines(folder / HISTORY, history)
    write_json(folder / DATASET, _dataset(places))
    _keep(folder, kept, [line["name"] for line in models] + list(BASELINES))
    return folder


def _digest(name: str) -> str:
    return name.encode().hex()[-32:]


def _published(error: float) -> dict[str, float]:
    spheres = [name_of("spheres", ball, part, variant) for ball in SPHERES for part in SPHERE_PARTS
               for variant in ("compat", "fixed")]  # fmt: skip
    array = [name_of("array", part, variant) for part in ARRAY_PARTS
             for variant in ("compat", "fixed")]  # fmt: skip
    return dict.fromkeys([*spheres, *array, "light-direction-compat"], error)


def _model(name, experiment, kind, seed, converged, seen) -> dict:
    return {
        "name": name, "digest": _digest(name), "kind": kind, "experiment": experiment,
        "size": "two-core", "seed": seed, "input_px": 64, "views": "object", "materials": 1,
        "noise_deg": 0.0, "smooth_px": 0.0, "converged": converged, "samples": 5000,
        "steps": 2080, "epochs": 10, "hours": 0.2, "cpu_hours": 0.2, "parameters": 321000,
        "coding": {"brightest": 1000.0, "color": "lab"}, "seen": seen,
        "speed": {"p50_ms": 4.2, "p95_ms": 5.0, "cpu_ms": 8.0, "fps": 238.1, "runs": 100,
                  "gflops": 0.08, "parameters": 321000, "file_mb": 1.3, "memory_mb": 22.0,
                  "hardware": "cpu, 2 threads of a processor"} if seed == 0 else None,
    }  # fmt: skip


def _history(name, experiment, seed, last, slow, converged) -> list[dict]:
    rng = np.random.default_rng([seed, 3])
    curve = [last * (1 + 1.5 * np.exp(-(epoch + rng.uniform(0, 0.2)) / slow))
             for epoch in range(10)]  # fmt: skip
    return [
        {"model": name, "experiment": experiment, "size": "two-core", "seed": seed,
         "converged": converged, "epoch": number, "step": 208 * number, "loss": value / 2000,
         "validation": value / 2000, "ssd": value}
        for number, value in enumerate(curve, start=1)
    ]  # fmt: skip


def _dataset(places: int) -> dict:
    def split(name: str, count: int) -> dict:
        return {
            "samples": count, "places": [f"{name} {n}" for n in range(places)], "maps": places,
            "objects": 20, "kinds": {"native": count}, "categories": {"sky_only": count},
            "histograms": {
                "light_elevation_deg": {"edges": [-90, 0, 45, 90], "counts": [1, 5, count]},
                "light_directedness": {"edges": [0, 0.5, 1], "counts": [3, count]},
            },
        }  # fmt: skip

    probes = [{"probe": f"map {n}", "place": f"place {n}", "kind": "native",
               "category": "sky_only", "split": "test", "samples": 10, "directedness": 0.4,
               "elevation_deg": 30.0} for n in range(places)]  # fmt: skip
    return {"name": "made-up", "judged": "test", "probes": probes,
            "splits": {name: split(name, count) for name, count in
                       (("train", 500), ("validation", 60), ("test", 60))}}  # fmt: skip


def _keep(folder: Path, samples: list[StereoSample], predictors: list[str]) -> None:
    shelf = Kept(folder)
    for sample in samples:
        shelf.add_sample(sample)
        for number, name in enumerate(predictors):
            guess = sample.truth * np.float32(0.6 + 0.05 * number)
            shelf.add_prediction(_digest(name), sample.key, guess)


def lines_of(path: Path) -> list[dict]:
    """The records of a .jsonl file."""
    return [json.loads(line) for line in path.read_text().splitlines()]

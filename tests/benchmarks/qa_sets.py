"""What expansion methods distort, as sets of maps beside the true probes.

    python tests/benchmarks/qa_sets.py PANOKIT_DATA OUT [--camera A] [--model ID] [--onnx FILE]

Photographs every usable probe with a test camera, brings the pictures back by each method, and
compares the sets with the truth: the tables of docs/ideas/qa-sets.md. A network from a file
(--onnx) judges the probes of fold 0 only, which panokit's ExpandNet has not seen.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from panokit.color.camera import photograph
from panokit.envmap import EnvironmentMap
from panokit.evaluate.peers import onnx_method
from panokit.evaluate.predictors import analytic_methods, model_method
from panokit.evaluate.probe_set import assign_folds, read_probes
from panokit.evaluate.scoring import CAMERAS
from panokit.io import write_environment_map
from panokit.qa.sets import DescriptionStore, compare_sets, members_of
from panokit.sphere import resize_radiance

FOLDS = 5
WIDTH_PX = 512
FIRST_SEED = 1_000_000_000


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--camera", default="A", choices=sorted(CAMERAS))
    parser.add_argument("--model", default="expand-2")
    parser.add_argument("--onnx", type=Path)
    options = parser.parse_args()
    probes = read_probes(options.data / "probes")
    folds = assign_folds(probes, FOLDS)
    methods = [m for m in analytic_methods() if m.name != "LDR"] + [model_method(options.model)]
    of_fold_0 = [onnx_method(options.onnx)] if options.onnx else []
    for index, (probe, fold) in enumerate(zip(probes, folds, strict=True)):
        radiance = probe.radiance()
        save(radiance, options.out / "truth" / f"{probe.name}.exr")
        shot = photograph(radiance, CAMERAS[options.camera], seed=FIRST_SEED + index)
        for method in [*methods, *(of_fold_0 if fold == 0 else [])]:
            path = options.out / method.name.replace(" ", "-") / f"{probe.name}.exr"
            if not path.exists():
                save(method.predictor(int(fold)).predict(shot.pixels), path)
    store = DescriptionStore(options.out / "descriptions.jsonl")
    known = {probe.name: probe for probe in probes}
    fold_0 = {probe.name for probe, fold in zip(probes, folds, strict=True) if fold == 0}

    def members(folder, names):
        return [
            replace(one, category=known[one.name].category, group=known[one.name].group)
            for one in members_of(options.out / folder)
            if one.name in names
        ]

    for names, compared in ((fold_0, [*methods, *of_fold_0]), (set(known), methods)):
        truth = members("truth", names)
        print(f"\n{len(truth)} probes, camera {options.camera}\n")
        for method in compared:
            found = compare_sets(members(method.name.replace(" ", "-"), names), truth, store=store)
            print(method.name, found.effects)
            for change in found.changes:
                if change.shift is not None:
                    ours, theirs = change.shift.augmented[2], change.shift.reference[2]
                    told = f"{change.effect} ({change.reason})"
                    print(f"  {change.descriptor.label:34} {theirs:9.3g} {ours:9.3g}  {told}")


def save(radiance, path):
    small = np.ascontiguousarray(resize_radiance(np.asarray(radiance, np.float32), WIDTH_PX))
    write_environment_map(EnvironmentMap(radiance=small), path)


if __name__ == "__main__":
    main()

"""The light of the augmentation ablation: the same LDR panoramas, expanded and plainly linearized.

    python tests/benchmarks/augmentation_maps.py PROBES CITY TRAINING MODELS OUT

PROBES is a folder of probes with a manifest, CITY one of EXR maps of synthetic places, TRAINING a
stereo dataset whose training places are divided, and MODELS the expansion models of a
cross-validation, "folder/fold_{fold}". All synthetic places and 24 others, drawn by a fixed seed,
lose their HDR light: OUT/expanded and OUT/linearized get their maps, OUT/places.json says which
places they are and which stay for reference.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from panokit.capture import Capture, license_from_spdx
from panokit.dataset.storage.index import read_index
from panokit.envmap import EnvironmentMap
from panokit.evaluate.predictors import analytic_methods, model_method
from panokit.evaluate.probe_set import ListedProbe, assign_folds, read_probes
from panokit.evaluate.scoring import take_picture
from panokit.io import write_environment_map
from panokit.io.files import sha256_of_file

FOLDS, DRAWN, SEED, CAMERA = 5, 24, 2018, "A"


def divide(training: Path) -> dict[str, list[str]]:
    """Places whose light stays, and those that are to be known from pictures alone."""
    rows = read_index(training, ["split", "place"]).to_pylist()
    places = sorted({row["place"] for row in rows if row["split"] == "train"})
    synthetic = [place for place in places if place.startswith("synthetic")]
    captured = [place for place in places if not place.startswith("synthetic")]
    order = np.random.default_rng(SEED).permutation(len(captured))
    augmented = sorted({*synthetic, *(captured[index] for index in order[:DRAWN])})
    return {"reference": sorted(set(places) - set(augmented)), "augmented": augmented}


def main() -> None:
    """Make all maps."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("probes", "city", "training"):
        parser.add_argument(name, type=Path)
    parser.add_argument("models")
    parser.add_argument("out", type=Path)
    asked = parser.parse_args()
    places = divide(asked.training)
    asked.out.mkdir(parents=True, exist_ok=True)
    (asked.out / "places.json").write_text(json.dumps(places, indent=1), encoding="utf-8")
    probes = read_probes(asked.probes)
    folds = [int(fold) for fold in assign_folds(probes, FOLDS)]
    for path in sorted(asked.city.glob("*.exr")):
        probes.append(
            ListedProbe(name=path.stem, path=path, category="urban",
                        group=f"synthetic-{path.stem}", sha256=sha256_of_file(path))
        )  # fmt: skip
        folds.append(0)
    # Of the analytic methods the second undoes the display curve and no more.
    methods = {"expanded": model_method(asked.models), "linearized": analytic_methods()[1]}
    credit = license_from_spdx("CC0-1.0", "Poly Haven")
    for index, (probe, fold) in enumerate(zip(probes, folds, strict=True)):
        if probe.group not in places["augmented"]:
            continue
        picture = take_picture(probe, probe.radiance(), CAMERA, index=index, fold=fold)
        for name, method in methods.items():
            radiance = method.predictor(fold).predict(picture.pixels)
            capture = Capture(provider="test", id=probe.name, place=probe.group, license=credit)
            (asked.out / name).mkdir(exist_ok=True)
            write_environment_map(
                EnvironmentMap(radiance=np.ascontiguousarray(radiance, np.float32),
                               capture=capture),
                asked.out / name / f"{probe.name}.exr",
            )  # fmt: skip


if __name__ == "__main__":
    main()

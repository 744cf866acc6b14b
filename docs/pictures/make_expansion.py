"""Draws expansion.jpg: all methods on a probe that the network has not seen, beside the truth.

python make_expansion.py PROBES 'FOLDS/fold-{fold}' quarry_02
"""

import sys
from pathlib import Path

import numpy as np

from panokit.capture import local_capture
from panokit.envmap import EnvironmentMap
from panokit.evaluate.predictors import model_method
from panokit.evaluate.probe_set import assign_folds, find_probes
from panokit.evaluate.scoring import take_picture
from panokit.expand import ExpandSettings
from panokit.expand.compare import compare_methods, comparison_picture
from panokit.io.images import encode_jpeg
from panokit.panorama import Panorama


def main(probes: str, models: str, name: str) -> None:
    every = find_probes(Path(probes))
    folds = assign_folds(every, 5).tolist()
    index = [probe.name for probe in every].index(name)
    probe, fold = every[index], folds[index]
    picture = take_picture(probe, probe.radiance(), "A", index=index, fold=fold)
    radiance = model_method(models).predictor(fold).predict(picture.pixels)
    panorama = Panorama(pixels=picture.pixels, capture=local_capture(name))
    maps = compare_methods(panorama, ExpandSettings(), EnvironmentMap(radiance=radiance))
    truth = EnvironmentMap(radiance=picture.truth.astype(np.float32))
    drawn = comparison_picture({**maps, "truth": truth})
    target = Path(__file__).with_name("expansion.jpg")
    target.write_bytes(encode_jpeg(drawn, quality=85))


if __name__ == "__main__":
    main(*sys.argv[1:])

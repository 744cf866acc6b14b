"""A small dataset on disk, as `panokit dataset render` makes it, by the analytic renderer."""

from pathlib import Path

import numpy as np

from panokit.capture import Capture, license_from_spdx
from panokit.dataset.production.library_maker import open_maker
from panokit.dataset.production.produce import render_dataset
from panokit.dataset.production.settings import ProductionSettings
from panokit.dataset.settings import DatasetSettings, ObjectSettings, RigSettings
from panokit.envmap import EnvironmentMap
from panokit.io import write_environment_map

WIDTH_PX = 32
COUNT = 24


def render_small(folder: Path) -> Path:
    """A dataset of 32-pixel pairs in `folder`, about two thirds of it for training."""
    maps = folder / "maps"
    for number in range(10):
        rng = np.random.default_rng(number)
        radiance = rng.uniform(0.2, 1, (32, 64, 3)).astype(np.float32)
        radiance[6, 6 * number : 6 * number + 2] = 60
        capture = Capture(provider="test", id=f"m{number}", place=f"place {number}",
                          license=license_from_spdx("CC0-1.0", "Somebody"))  # fmt: skip
        write_environment_map(
            EnvironmentMap(radiance=radiance, capture=capture), maps / f"m{number}.exr"
        )
    settings = DatasetSettings(
        renderer="analytic", samples=2, validation_share=0.25, test_share=0.1,
        objects=ObjectSettings(kinds=("vase", "mug"), per_kind=8),
        rig=RigSettings(width_px=WIDTH_PX),
    )  # fmt: skip
    production = ProductionSettings(count=COUNT, shard_samples=8, workers=0)
    return render_dataset(open_maker(settings, [maps]), folder / "stereo", production).folder

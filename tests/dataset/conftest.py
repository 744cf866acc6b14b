import shutil

import numpy as np
import pytest

from panokit.capture import Capture, license_from_spdx
from panokit.dataset.production.produce import render_dataset
from panokit.dataset.production.settings import ProductionSettings
from panokit.envmap import EnvironmentMap
from panokit.probes import Library
from tests.dataset.fake import FakeMaker

COUNT, SHARD = 40, 8


@pytest.fixture(scope="session")
def finished_dataset(tmp_path_factory):
    """A dataset of 40 samples that a run made undisturbed; do not write to it."""
    out = tmp_path_factory.mktemp("dataset") / "stereo"
    production = ProductionSettings(count=COUNT, shard_samples=SHARD, workers=0)
    render_dataset(FakeMaker(), out, production)
    return out


@pytest.fixture
def own_dataset(finished_dataset, tmp_path):
    """A copy of it that may be damaged."""
    return shutil.copytree(finished_dataset, tmp_path / "stereo")


@pytest.fixture(scope="session")
def library(tmp_path_factory):
    """A probe library of six places."""
    folder = tmp_path_factory.mktemp("library")
    with Library.create(folder) as shelves:
        for number in range(6):
            rng = np.random.default_rng(number)
            radiance = rng.uniform(0.2, 1, (32, 64, 3)).astype(np.float32)
            radiance[6, 10 * number : 10 * number + 2] = 60
            capture = Capture(
                provider="test", id=f"m{number}", place=f"place {number}",
                license=license_from_spdx("CC-BY-SA-4.0", f"Mapper {number}"),
            )  # fmt: skip
            shelves.add(EnvironmentMap(radiance=radiance, capture=capture))
    return folder

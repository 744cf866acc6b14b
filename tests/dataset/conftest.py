import shutil

import pytest

from panokit.dataset.produce import render_dataset
from panokit.dataset.production import ProductionSettings
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

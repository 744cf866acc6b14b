import pytest

from panokit.dataset.production.produce import render_dataset
from panokit.dataset.production.settings import ProductionSettings
from tests.dataset.conftest import COUNT, SHARD
from tests.dataset.fake import FakeMaker


@pytest.mark.slow
def test_dask_makes_the_same_shards_and_tells_of_every_sample(finished_dataset, tmp_path):
    out = tmp_path / "stereo"
    production = ProductionSettings(count=COUNT, shard_samples=SHARD, workers=2, engine="dask")
    result = render_dataset(FakeMaker(), out, production)
    assert (result.made, result.samples) == (COUNT, COUNT)
    shards = sorted((finished_dataset / "shards").iterdir())
    assert shards
    for path in shards:
        assert (out / "shards" / path.name).read_bytes() == path.read_bytes()

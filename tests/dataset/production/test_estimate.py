import shutil

import pytest

from panokit.dataset.production.estimate import estimate_dataset
from panokit.dataset.production.settings import ProductionSettings
from panokit.errors import ItemError
from tests.dataset.conftest import COUNT, SHARD
from tests.dataset.fake import FakeMaker


def test_sizes_and_splits_are_those_of_the_dataset(finished_dataset, tmp_path):
    production = ProductionSettings(count=COUNT, shard_samples=SHARD, workers=2)
    found = estimate_dataset(FakeMaker(), tmp_path / "new", production)
    assert found.splits == {"train": 32, "validation": 5, "test": 3}
    assert found.shards == 6
    true_size = sum(path.stat().st_size for path in finished_dataset.glob("shards/*.tar"))
    assert found.bytes == pytest.approx(true_size, rel=0.05)
    assert found.fits
    assert not (tmp_path / "new").exists()


def test_a_disk_that_is_too_small_is_noticed(tmp_path, monkeypatch):
    usage = shutil.disk_usage(tmp_path)._replace(free=1_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    found = estimate_dataset(FakeMaker(), tmp_path, ProductionSettings(count=100))
    assert found.bytes > 5e6
    assert not found.fits


def test_rejections_count_and_vain_ones_end_it(tmp_path):
    maker = FakeMaker(troubles={1: "blank-twice"})
    found = estimate_dataset(maker, tmp_path, ProductionSettings(count=10))
    assert found.rejected == {"blank-mask": 2}
    hopeless = FakeMaker(troubles=dict.fromkeys(range(5), "blank"))
    with pytest.raises(ItemError, match="The object covers nothing"):
        estimate_dataset(hopeless, tmp_path, ProductionSettings(count=5))

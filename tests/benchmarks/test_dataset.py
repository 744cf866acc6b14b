"""How fast samples are read and written; run by `make bench`.

Warm file cache, one process. The sizes are those of a real 128x128 sample: 0.6 MB.
"""

from dataclasses import dataclass

import numpy as np
import pytest

from panokit.color.transfer import srgb_encode_u8
from panokit.dataset.production.produce import render_dataset
from panokit.dataset.production.settings import ProductionSettings
from panokit.dataset.sample import Sample
from panokit.dataset.storage.members import exr_bytes
from panokit.dataset.storage.read import StereoDataset
from panokit.dataset.storage.sampling import ShardSampler
from panokit.dataset.storage.shards import tar_bytes, write_shard
from panokit.dataset.storage.verify import verify_dataset
from panokit.io.images import encode_png
from tests.dataset.fake import FakeMaker, fake_sample

COUNT, BATCH = 96, 24


@dataclass(frozen=True, slots=True, kw_only=True)
class LargeMaker(FakeMaker):
    """Samples with pictures and maps as large as real ones."""

    def make(self, index, attempt):
        small = fake_sample(0, index, attempt, self.split_of(index))
        rng = np.random.default_rng(index)
        smooth = rng.random((16, 16, 3)).repeat(8, 0).repeat(8, 1) + rng.normal(
            0, 0.02, (128, 128, 3)
        )
        picture = encode_png(srgb_encode_u8(np.clip(smooth, 0, 1)))
        light = rng.gamma(0.3, 1.0, (128, 256, 3)).astype(np.float32)
        large = {
            "left.png": picture,
            "right.png": picture,
            "background.png": picture,
            "env.exr": exr_bytes(light),
            "env64.exr": exr_bytes(light.reshape(64, 2, 64, 4, 3).mean(axis=(1, 3))),
        }
        members = {name: large.get(name, data) for name, data in small.members.items()}
        return Sample(
            key=small.key, split=small.split, members=members, meta=small.meta, views=(), figures={}
        )


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    out = tmp_path_factory.mktemp("large") / "stereo"
    render_dataset(LargeMaker(), out, ProductionSettings(count=COUNT, workers=0))
    return out


def read_batch(dataset, numbers):
    return [dataset[number] for number in numbers]


def test_random_reading_of_what_a_network_needs(benchmark, large):
    """Two views, background and target, decoded."""
    dataset = StereoDataset(large)
    numbers = list(ShardSampler(dataset.shard_sizes))[:BATCH]
    batch = benchmark(read_batch, dataset, numbers)
    benchmark.extra_info["samples_per_s"] = BATCH / benchmark.stats["mean"]
    assert len(batch) == BATCH


def test_random_reading_without_decoding(benchmark, large):
    dataset = StereoDataset(large)
    numbers = list(ShardSampler(dataset.shard_sizes))[:BATCH]

    def read():
        return [[dataset.read(n, name) for name in dataset.members] for n in numbers]

    assert len(benchmark(read)) == BATCH
    benchmark.extra_info["samples_per_s"] = BATCH / benchmark.stats["mean"]


def test_opening(benchmark, large):
    assert len(benchmark(StereoDataset, large)) == COUNT


def test_writing_a_shard(benchmark, tmp_path):
    maker = LargeMaker()
    samples = [maker.make(index, 0) for index in range(BATCH)]

    def write():
        write_shard(tmp_path / "a.tar", (tar_bytes(s.key, s.members) for s in samples))

    benchmark(write)
    benchmark.extra_info["samples_per_s"] = BATCH / benchmark.stats["mean"]


def test_verifying(benchmark, large):
    found = benchmark.pedantic(verify_dataset, (large,), rounds=3)
    assert found.samples == COUNT


def test_an_order_of_55_000_samples(benchmark):
    sampler = ShardSampler([250] * 220, world=4, window=4096)
    assert len(benchmark(lambda: list(sampler))) == 13_750

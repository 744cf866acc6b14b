"""Publishing to S3 and reading from there, against a stand-in on this machine."""

import json
from importlib.util import find_spec

import numpy as np
import pytest

from panokit.dataset import ProductionSettings, render_dataset
from panokit.dataset.storage.read import StereoDataset
from panokit.dataset.storage.remote import RemoteDataset
from panokit.errors import MissingExtraError
from panokit.io.remote import OPTIONS_VARIABLE, open_remote
from panokit.pipeline.publishing import publish, pull
from tests.dataset.fake import FakeMaker
from tests.pipeline.s3_stand_in import S3StandIn


@pytest.fixture
def s3(monkeypatch):
    with S3StandIn() as server:
        options = {
            "endpoint_url": server.url,
            "key": "k",
            "secret": "s",
            "use_listings_cache": False,
        }
        monkeypatch.setenv(OPTIONS_VARIABLE, json.dumps(options))
        yield server


# s3fs is an extra; where it is installed this runs.
@pytest.mark.tool
@pytest.mark.skipif(find_spec("s3fs") is None, reason="s3fs is not installed")
def test_a_dataset_goes_to_s3_and_is_read_by_ranges(s3, tmp_path, console):
    render_dataset(FakeMaker(), tmp_path / "set", ProductionSettings(count=20, workers=0))
    assert publish(tmp_path / "set", "s3://bucket/set", console) > 2
    assert publish(tmp_path / "set", "s3://bucket/set", console) == 0
    near, far = StereoDataset(tmp_path / "set", "train"), RemoteDataset("s3://bucket/set", "train")
    one, other = near[3], far[3]
    assert all(np.array_equal(one[name], other[name]) for name in one)
    # Not the whole shard for one picture.
    first, last = s3.ranges[-1].removeprefix("bytes=").split("-")
    shard = next(len(v) for k, v in s3.objects.items() if "train-00000.tar" in k)
    assert int(last) - int(first) < shard / 4
    assert pull("s3://bucket/set", tmp_path / "copy", console) > 2
    assert len(StereoDataset(tmp_path / "copy", "train")) == len(near)


def test_without_the_extra_it_is_named(monkeypatch):
    def absent(*_, **__):
        raise ImportError("Install s3fs to access S3")

    monkeypatch.setattr("fsspec.core.url_to_fs", absent)
    with pytest.raises(MissingExtraError, match=r"panokit\[s3\]"):
        open_remote("s3://bucket/x")

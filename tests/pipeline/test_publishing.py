"""What a run made, published to a place behind a URL and read from there."""

import itertools
import json
import pickle

import fsspec
import numpy as np
import pytest

from panokit.dataset import ProductionSettings, render_dataset
from panokit.dataset.storage.read import StereoDataset
from panokit.dataset.storage.remote import RemoteDataset
from panokit.errors import RecordError, StorageError, UsageError
from panokit.io.remote import LIST
from panokit.pipeline import run_pipeline
from panokit.pipeline.publishing import publish, published_names, pull
from panokit.probes import Library
from tests.dataset.fake import FakeMaker

_NUMBERS = itertools.count()


@pytest.fixture(params=["memory", "file", "path"])
def place(request, tmp_path):
    """A place of each kind, new for each test."""
    if request.param == "memory":
        return f"memory://bucket{next(_NUMBERS)}/made"
    prefix = "file://" if request.param == "file" else ""
    return f"{prefix}{tmp_path / 'far away'}"


@pytest.fixture
def library(tmp_path, sunny):
    with Library.create(tmp_path / "library") as library:
        library.add(sunny, name="sunny")
    return tmp_path / "library"


def test_a_library_goes_there_and_comes_back(place, library, tmp_path, console):
    assert publish(library, place, console) == 3
    assert publish(library, place, console) == 0
    assert pull(place, tmp_path / "copy", console) == 3
    assert pull(place, tmp_path / "copy", console) == 0
    with Library.open(tmp_path / "copy") as copy, Library.open(library) as original:
        (one,), (same,) = copy.list(), original.list()
        assert one == same
        assert np.array_equal(copy.read(one.id).radiance, original.read(one.id).radiance)
        assert copy.verify().problems == ()


def test_what_was_changed_there_is_not_taken(library, tmp_path, console):
    place = f"memory://bucket{next(_NUMBERS)}/made"
    publish(library, place, console)
    files, root = fsspec.core.url_to_fs(place)
    (probe,) = [path for path in files.find(root) if path.endswith("probe.exr")]
    files.pipe_file(probe, b"other")
    with pytest.raises(RecordError, match=r"probe\.exr is not what was published"):
        pull(place, tmp_path / "copy", console)
    # Publishing goes by the list, so whoever changes files there takes the list away.
    files.rm(f"{root}/{LIST}")
    assert publish(library, place, console) == 3
    assert pull(place, tmp_path / "copy", console) > 0


def test_an_attempt_that_was_interrupted_is_gone_on_with(library, console, monkeypatch):
    place = f"memory://bucket{next(_NUMBERS)}/made"
    files, root = fsspec.core.url_to_fs(place)
    put, left = type(files).put_file, [2]

    def failing(self, source, target, **more):
        if not left[0]:
            raise OSError(28, "No space left on device")
        left[0] -= 1
        return put(self, source, target, **more)

    monkeypatch.setattr(type(files), "put_file", failing)
    with pytest.raises(StorageError, match="No space left"):
        publish(library, place, console)
    assert not files.exists(f"{root}/{LIST}")
    monkeypatch.setattr(type(files), "put_file", put)
    assert publish(library, place, console) == 3


def test_samples_are_read_where_they_lie(place, tmp_path, console):
    render_dataset(FakeMaker(), tmp_path / "set", ProductionSettings(count=20, workers=0))
    publish(tmp_path / "set", place, console)
    # The credits go with the samples, and all that the card shows.
    assert {"README.md", "ATTRIBUTION.md", "ATTRIBUTION.csv", "sheet.jpg", "histograms.png"} <= set(
        published_names(tmp_path / "set")
    )
    near, far = StereoDataset(tmp_path / "set", "train"), RemoteDataset(place, "train")
    assert list(far.keys) == list(near.keys)
    again = pickle.loads(pickle.dumps(far))
    for number in (0, len(near) - 1):
        one, other = near[number], again[number]
        assert one.keys() == other.keys()
        assert all(np.array_equal(one[name], other[name]) for name in one)
    with pytest.raises(UsageError, match="no member"):
        far.read(0, "nothing.png")


def test_a_run_publishes_what_it_made_at_its_end(settings, console, tmp_path):
    place = f"memory://bucket{next(_NUMBERS)}/made"
    asked = settings.model_copy(update={"publish": place})
    result = run_pipeline(asked, console)
    probes = len(result.batches[-1].receipts)
    assert probes > 0
    assert pull(f"{place}/library", tmp_path / "copy", console) == 3 * probes
    with Library.open(tmp_path / "copy") as library:
        assert len(library) == probes
    (result.run.root / "published.json").write_text("half of it")
    assert run_pipeline(asked, console).nothing_to_do
    assert json.loads((result.run.root / "published.json").read_text()) == {"url": place}


def test_places_that_are_none(library, tmp_path, console):
    with pytest.raises(StorageError, match="Nothing was published"):
        pull(f"memory://bucket{next(_NUMBERS)}/none", tmp_path / "copy", console)
    with pytest.raises(UsageError, match="no probe library"):
        publish(tmp_path, "memory://x", console)
    with pytest.raises(UsageError, match="nosuch"):
        publish(library, "nosuch://x/y", console)

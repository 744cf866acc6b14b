"""A small stereo dataset as packs, made by the tiny renderer; no files of shards are needed."""

import numpy as np
import pytest

from tests.dataset.tiny import tiny_members
from tests.train.stereo.rendered import render_small


@pytest.fixture(scope="session")
def members(tmp_path_factory):
    """Decoded members of twelve samples, each with its key and its meta."""
    folder = tmp_path_factory.mktemp("maps")
    return tiny_members(folder, 12, places=4, width_px=32, kinds=("vase", "mug"))


@pytest.fixture(scope="session")
def pack(members):
    from panokit.train.stereo.pack import MAPS, PICTURES, Pack

    arrays = {name: np.stack([one[name] for one in members]) for name in (*PICTURES, *MAPS)}
    arrays["normal"] = np.stack([one["left_normal"] for one in members]).astype(np.float16)
    arrays["part"] = (np.stack([one["left_mask"] for one in members]) >= 128).astype(np.uint8)
    return Pack(
        keys=np.array([one["key"] for one in members]),
        places=np.array([one["meta"]["probe"]["place"] for one in members]),
        arrays=arrays,
    )


@pytest.fixture(scope="session")
def small_dataset(tmp_path_factory):
    """A dataset of 24 pairs on disk; do not write to it."""
    return render_small(tmp_path_factory.mktemp("small"))

"""A small stereo dataset as packs, made by the tiny renderer; no files of shards are needed."""

import numpy as np
import pytest

from panokit.capture import Capture, license_from_spdx
from panokit.dataset.make import make_sample
from panokit.dataset.plan import draw_plan
from panokit.dataset.renderers import make_renderer
from panokit.dataset.settings import DatasetSettings, ObjectSettings, RigSettings
from panokit.dataset.stock import open_stock
from panokit.dataset.storage.decode import decode_member
from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError
from panokit.io import write_environment_map
from panokit.sphere import equirect_directions


@pytest.fixture(scope="session")
def members(tmp_path_factory):
    """Decoded members of twelve samples, each with its key and its meta."""
    folder = tmp_path_factory.mktemp("maps")
    rng = np.random.default_rng(0)
    for number in range(4):
        sun = rng.normal(0, 1, 3)
        sun = np.abs(sun) / np.linalg.norm(sun)
        near = np.exp(40 * (equirect_directions(64, 32) @ sun - 1))[..., None]
        radiance = (0.4 + 15 * near * np.ones(3)).astype(np.float32)
        capture = Capture(provider="test", id=f"m{number}", place=f"place {number}",
                          license=license_from_spdx("CC0-1.0", "Somebody"))  # fmt: skip
        write_environment_map(
            EnvironmentMap(radiance=radiance, capture=capture), folder / f"m{number}.exr"
        )
    settings = DatasetSettings(
        renderer="analytic", samples=4, validation_share=0, test_share=0,
        objects=ObjectSettings(kinds=("vase", "mug"), per_kind=4), rig=RigSettings(width_px=32),
    )  # fmt: skip
    stock = open_stock(settings, [folder])
    renderer = make_renderer("analytic")
    found = []
    for index in range(60):
        try:
            made = make_sample(draw_plan(settings, stock, index), settings, stock, renderer)
        except ImageError:
            continue
        files = {name.rpartition(".")[0]: decode_member(name, data)
                 for name, data in made.members.items()}  # fmt: skip
        found.append(files | {"key": made.key})
        if len(found) == 12:
            return found
    raise AssertionError("too few usable samples")


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

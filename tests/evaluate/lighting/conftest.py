"""A few stereo samples, made by the tiny renderer."""

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
from panokit.evaluate.lighting.sample import sample_of
from panokit.io import write_environment_map
from panokit.sphere import equirect_directions


def sunny(azimuth_deg: float, seed: int) -> EnvironmentMap:
    """A soft sky with a sun at 35 degrees, over a darker ground."""
    directions = equirect_directions(64, 32)
    toward = np.deg2rad([azimuth_deg, 35.0])
    sun = np.array([np.cos(toward[1]) * np.sin(toward[0]), np.sin(toward[1]),
                    -np.cos(toward[1]) * np.cos(toward[0])])  # fmt: skip
    near = np.exp(60 * (directions @ sun - 1))[..., None]
    sky = np.where(directions[..., 1:2] > 0, [0.4, 0.5, 0.7], [0.2, 0.18, 0.15])
    capture = Capture(provider="test", id=f"m{seed}", place=f"place {seed}",
                      license=license_from_spdx("CC0-1.0", "Somebody"))  # fmt: skip
    return EnvironmentMap(radiance=(sky + 20 * near).astype(np.float32), capture=capture)


@pytest.fixture(scope="session")
def samples(tmp_path_factory):
    """Six samples of vases in sunlight."""
    folder = tmp_path_factory.mktemp("maps")
    for number in range(6):
        write_environment_map(sunny(60.0 * number, number), folder / f"m{number}.exr")
    settings = DatasetSettings(
        renderer="analytic", samples=4, validation_share=0, test_share=0,
        objects=ObjectSettings(kinds=("vase",), per_kind=4), rig=RigSettings(width_px=48),
    )  # fmt: skip
    stock = open_stock(settings, [folder])
    renderer = make_renderer("analytic")
    found = []
    for index in range(30):
        try:
            made = make_sample(draw_plan(settings, stock, index), settings, stock, renderer)
        except ImageError:
            continue
        files = {name.rpartition(".")[0]: decode_member(name, data)
                 for name, data in made.members.items()}  # fmt: skip
        found.append(sample_of(files | {"key": made.key}))
        if len(found) == 6:
            return found
    raise AssertionError("too few usable samples")

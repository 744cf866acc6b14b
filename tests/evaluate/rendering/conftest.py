"""A stereo sample of a vase in sunlight, made by the tiny renderer."""

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
from tests.conftest import sun_radiance


@pytest.fixture(scope="session")
def vase(tmp_path_factory):
    folder = tmp_path_factory.mktemp("maps")
    capture = Capture(
        provider="test", id="m", place="p", license=license_from_spdx("CC0-1.0", "Somebody")
    )
    soft = np.exp(40 * (equirect_directions(64, 32) @ np.array([-0.7, 0.6, 0.4]) - 1))[..., None]
    radiance = sun_radiance(64, 35, sun=1.0, diameter_deg=5) + 20 * soft
    light = EnvironmentMap(radiance=radiance.astype(np.float32), capture=capture)
    write_environment_map(light, folder / "m.exr")
    settings = DatasetSettings(
        renderer="analytic", samples=4, validation_share=0, test_share=0,
        objects=ObjectSettings(kinds=("vase",), per_kind=4), rig=RigSettings(width_px=48),
    )  # fmt: skip
    stock, renderer = open_stock(settings, [folder]), make_renderer("analytic")
    for index in range(20):
        try:
            made = make_sample(draw_plan(settings, stock, index), settings, stock, renderer)
        except ImageError:
            continue
        files = {name.rpartition(".")[0]: decode_member(name, data)
                 for name, data in made.members.items()}  # fmt: skip
        return sample_of(files | {"key": made.key})
    raise AssertionError("no usable sample")

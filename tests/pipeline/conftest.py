"""A run made of small local pictures: no network, analytic expansion."""

import numpy as np
import pytest

from panokit.console import Console
from panokit.expand.settings import ExpandSettings
from panokit.fetch.settings import FetchSettings
from panokit.inpaint.settings import InpaintSettings
from panokit.io.images import encode_jpeg
from panokit.pipeline import PipelineSettings
from panokit.sphere import equirect_directions


def street_jpeg(seed, size=(128, 256)):
    """A tiny street: gray ground, blue sky, a burnt sun."""
    rng = np.random.default_rng(seed)
    directions = equirect_directions(size[1], size[0])
    up = directions[..., 1:2]
    pixels = np.where(up > 0, [140, 160, 200], [115, 105, 95]) + rng.normal(0, 8, (*size, 1))
    sun = np.array([0.5, 0.6, -0.62])
    pixels[directions @ (sun / np.linalg.norm(sun)) > 0.995] = 255
    return encode_jpeg(np.clip(pixels, 0, 255).astype(np.uint8))


@pytest.fixture
def pictures(tmp_path):
    """A folder of three good pictures and one that is cut off."""
    folder = tmp_path / "pictures"
    folder.mkdir()
    for number in range(3):
        (folder / f"street{number}.jpg").write_bytes(street_jpeg(number))
    (folder / "broken.jpg").write_bytes(street_jpeg(9)[:900])
    return folder


@pytest.fixture
def settings(tmp_path, pictures):
    return PipelineSettings(
        name="tiny",
        output=tmp_path / "run",
        fetch=FetchSettings(source="folder", folder=pictures, license="CC0-1.0"),
        inpaint=InpaintSettings(nadir_deg=None),
        expand=ExpandSettings(model="reinhard", width_px=128),
    )


@pytest.fixture
def console():
    return Console(quiet=True)

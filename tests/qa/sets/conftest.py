"""Small skies with a sun, and sets of them: a street camera's world in 128x64 pixels."""

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.frames import direction_from_azimuth_elevation
from panokit.io import write_environment_map
from panokit.qa.sets import Member
from panokit.sphere import equirect_directions


def scene(seed, *, sun=1.0, warmth=0.0, width=128):
    """A random place: sky, ground, a few blocks of houses, and a sun of this strength."""
    random = np.random.default_rng(seed)
    directions = equirect_directions(width, width // 2)
    x, y, z = np.moveaxis(directions.astype(np.float64), -1, 0)
    azimuth = np.arctan2(x, -z)
    skyline = np.zeros_like(azimuth)
    for _ in range(6):
        middle, half, height = (
            random.uniform(-3, 3),
            random.uniform(0.1, 0.5),
            random.uniform(0, 0.6),
        )
        skyline = np.where(np.abs(azimuth - middle) < half, np.maximum(skyline, height), skyline)
    sky = np.array([0.35, 0.5, 0.8]) * (0.6 + 0.4 * y[..., None])
    ground = np.array([0.2, 0.17, 0.13]) * random.uniform(0.7, 1.4)
    houses = np.array([0.3, 0.27, 0.22]) * random.uniform(0.7, 1.4)
    texture = 1 + 0.2 * random.standard_normal((width // 2, width, 1))
    radiance = np.where((y > skyline)[..., None], sky, np.where((y > 0)[..., None], houses, ground))
    radiance = radiance * np.where((y > skyline)[..., None], 1, np.clip(texture, 0.4, 1.6))
    toward = direction_from_azimuth_elevation(
        random.uniform(-np.pi, np.pi), np.deg2rad(random.uniform(25, 70))
    )
    glow = np.exp((directions @ toward - 1) * 1500)[..., None]
    radiance = radiance + glow * sun * 900 * np.exp(random.normal(0, 0.4))
    radiance = radiance * np.exp2([warmth / 2, 0, -warmth / 2])
    return np.asarray(radiance, np.float32)


@pytest.fixture
def make_set(tmp_path):
    """Write maps to a folder and list them as a set: name -> radiance."""

    def make(folder, maps):
        members = []
        for name, radiance in maps.items():
            path = tmp_path / folder / f"{name}.exr"
            path.parent.mkdir(parents=True, exist_ok=True)
            write_environment_map(EnvironmentMap(radiance=np.ascontiguousarray(radiance)), path)
            members.append(Member(name=name, path=path))
        return members

    return make


@pytest.fixture
def scenes():
    return scene

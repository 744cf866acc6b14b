"""The real renderer sees and is lit by a beacon where it was."""

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.frames import TOOL_FROM_PANOKIT, direction_from_azimuth_elevation
from panokit.io.adapters import mitsuba_parameter, to_mitsuba
from panokit.renderer import environment_emitter, load_mitsuba
from panokit.sphere import equirect_directions, irradiance

pytestmark = pytest.mark.render

ANGLES = [(0, 0), (90, 10), (-90, -20), (170, 50), (-135, -70)]
HEIGHT = 64


def beacon(direction):
    directions = equirect_directions(2 * HEIGHT, HEIGHT).astype(np.float64)
    lobe = np.exp(500 * (directions @ direction - 1))[..., None]
    return EnvironmentMap(radiance=(lobe * [50, 30, 20] + 0.01).astype(np.float32).copy())


def camera(mi, forward, pixels=33, fov_deg=40.0):
    up = [0, 0, 1] if abs(forward[1]) > 0.8 else [0, 1, 0]
    return {
        "type": "perspective",
        "fov": fov_deg,
        "to_world": mi.ScalarTransform4f().look_at([0, 0, 0], list(forward), up),
        "film": {
            "type": "hdrfilm",
            "width": pixels,
            "height": pixels,
            "rfilter": {"type": "box"},
        },
    }


def picture_of(mi, emitter, forward):
    scene = mi.load_dict(
        {
            "type": "scene",
            "sky": emitter,
            "camera": camera(mi, forward),
            "path": {"type": "path"},
        }
    )
    return scene, np.array(mi.render(scene, spp=16))


def is_centered(picture):
    rows, columns = np.mgrid[:33, :33] - 16
    weight = np.maximum(picture[..., 0] - 1, 0)
    offset = np.array([(weight * rows).sum(), (weight * columns).sum()]) / weight.sum()
    # A pixel of the picture is 1.2 degrees, one of the map 2.8.
    return np.abs(offset).max() * 1.2 < 1.4 / 2 and picture[16, 16, 0] > 20


@pytest.mark.parametrize(("azimuth", "elevation"), ANGLES)
def test_a_beacon_appears_where_it_was(azimuth, elevation):
    mi = load_mitsuba()
    direction = direction_from_azimuth_elevation(np.deg2rad(azimuth), np.deg2rad(elevation))
    envmap = beacon(direction)
    # In Mitsuba's own axes, the array alone.
    emitter = {"type": "envmap", "bitmap": mi.Bitmap(to_mitsuba(envmap))}
    _, picture = picture_of(mi, emitter, TOOL_FROM_PANOKIT["mitsuba"].apply(direction).tolist())
    assert is_centered(picture)
    # And in panokit's, with the renderer's emitter.
    scene, picture = picture_of(mi, environment_emitter(envmap.radiance), direction.tolist())
    assert is_centered(picture)
    # A loaded scene keeps the very array that is set later.
    data = np.array(mi.traverse(scene)["sky.data"])
    assert data.shape[:2] == mitsuba_parameter(envmap).shape[:2]
    np.testing.assert_allclose(data[..., :3], mitsuba_parameter(envmap), rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize(("azimuth", "elevation"), ANGLES)
def test_a_beacon_lights_with_the_energy_it_had(azimuth, elevation):
    mi = load_mitsuba()
    direction = direction_from_azimuth_elevation(np.deg2rad(azimuth), np.deg2rad(elevation))
    envmap = beacon(direction)
    forward = (-direction).tolist()
    # A white sheet that faces the beacon; the camera looks at it with the light at its back.
    up = [0, 0, 1] if abs(direction[1]) > 0.8 else [0, 1, 0]
    sheet = {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f().look_at(forward, [0, 0, 0], up),
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [1.0, 1.0, 1.0]}},
    }
    scene = mi.load_dict(
        {
            "type": "scene",
            "sky": environment_emitter(envmap.radiance),
            "sheet": sheet,
            "camera": camera(mi, forward, pixels=4, fov_deg=20.0),
            "path": {"type": "path", "max_depth": 2},
        }
    )
    seen = np.array(mi.render(scene, spp=1024)).mean(axis=(0, 1))
    expected = irradiance(envmap.radiance, direction[None])[0] / np.pi
    np.testing.assert_allclose(seen, expected, rtol=0.02)

"""Beacons: a bright spot handed to a tool shines, by the tool's own formula, from where it was.

Each tool's formula from direction to texture coordinates is written out here from its own
documentation or source, apart from panokit's tables; the picture is then looked up as the tool
does, on a fine grid over its sphere.
"""

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError, UsageError
from panokit.frames import Frame, angle_between, direction_from_azimuth_elevation
from panokit.io.adapters import (
    from_blender,
    from_mitsuba,
    from_openexr_latlong,
    from_skylibs,
    from_threejs,
    mitsuba_parameter,
    to_blender,
    to_mitsuba,
    to_openexr_latlong,
    to_skylibs,
    to_threejs,
    usd_dome_light,
)
from panokit.sphere import energy, equirect_directions, light_vector

HEIGHT = 48
HALF_PIXEL = np.pi / HEIGHT / 2
PI = np.pi


def skylibs(d):
    """EnvironmentMap.world2pixel, latlong: v from the top, -Z in the middle."""
    x, y, z = d
    return (1 + np.arctan2(x, -z) / PI) / 2 * 2 * HEIGHT - 0.5, np.arccos(y) / PI * HEIGHT - 0.5


def mitsuba(d):
    """envmap.cpp: the last row of texels lies on the pole, columns have theirs inside."""
    x, y, z = d
    return np.arctan2(x, -z) / (2 * PI) % 1 * 2 * HEIGHT - 0.5, np.arccos(y) / PI * (HEIGHT - 1)


def openexr(d):
    """ImfEnvmap.cpp, LatLongMap: longitude grows to the left, texels on seam and poles."""
    x, y, z = d
    column = (np.arctan2(x, z) / (-2 * PI) + 0.5) * (2 * HEIGHT - 1)
    return column, (np.arcsin(y) / (-PI) + 0.5) * (HEIGHT - 1)


def blender(d):
    """Cycles, direction_to_equirectangular: Z is up, and rows count from below."""
    x, y, z = d
    u, v = 0.5 - np.arctan2(y, x) / (2 * PI), np.arctan2(z, np.hypot(x, y)) / PI + 0.5
    return u * 2 * HEIGHT - 0.5, v * HEIGHT - 0.5


def threejs(d):
    """common.glsl, equirectUv: rows of a DataTexture count from below."""
    x, y, z = d
    u, v = np.arctan2(z, x) / (2 * PI) + 0.5, np.arcsin(np.clip(y, -1, 1)) / PI + 0.5
    return u * 2 * HEIGHT - 0.5, v * HEIGHT - 0.5


# Tool: to it, from it, its lookup, and its name of panokit's direction (x, y, z).
TOOLS = {
    "skylibs": (to_skylibs, from_skylibs, skylibs, lambda x, y, z: (x, y, z)),
    "mitsuba": (to_mitsuba, from_mitsuba, mitsuba, lambda x, y, z: (-x, y, -z)),
    "openexr": (to_openexr_latlong, from_openexr_latlong, openexr, lambda x, y, z: (-x, y, -z)),
    "blender": (to_blender, from_blender, blender, lambda x, y, z: (-z, -x, y)),
    "threejs": (to_threejs, from_threejs, threejs, lambda x, y, z: (-z, y, x)),
}
DIRECTIONS = [
    direction_from_azimuth_elevation(np.deg2rad(azimuth), np.deg2rad(elevation))
    for azimuth, elevation in [
        (0, 0), (90, 0), (-90, 0), (180, 0), (179, 40), (-178, -60), (33, 77), (-120, 88),
        (10, -89), (65, -12), (0, 90),
    ]
]  # fmt: skip


def beacon(direction, sharpness=400.0):
    directions = equirect_directions(2 * HEIGHT, HEIGHT).astype(np.float64)
    lobe = np.exp(sharpness * (directions @ direction - 1))[..., None]
    return EnvironmentMap(
        radiance=(lobe * [300.0, 200.0, 100.0] + 1e-4).astype(np.float32), frame=Frame.WORLD
    )


def fine_sphere(count=12 * HEIGHT):
    polar = (np.arange(count) + 0.5) / count * PI
    around = (np.arange(count // 2) + 0.5) / count * 4 * PI
    polar, around = np.meshgrid(polar, around, indexing="ij")
    # Not along an axis of any tool: y is up here, for all of them alike.
    xyz = np.sin(polar) * np.cos(around), np.cos(polar), np.sin(polar) * np.sin(around)
    return np.array(xyz).reshape(3, -1), (np.sin(polar) * 4 * (PI / count) ** 2).ravel()


SPHERE, SOLID_ANGLES = fine_sphere()


def looked_up(array, column, row):
    """Bilinear, columns wrap, rows clamp: as renderers filter a texture."""
    height, width = array.shape[:2]
    row = np.clip(row, 0, height - 1)
    left, above = np.floor(column).astype(int), np.minimum(np.floor(row).astype(int), height - 2)
    s, t = (column - left)[:, None], (row - above)[:, None]
    at = lambda y, x: array[y, x % width, :3].astype(np.float64)  # noqa: E731
    return (
        (at(above, left) * (1 - s) + at(above, left + 1) * s) * (1 - t)
        + (at(above + 1, left) * (1 - s) + at(above + 1, left + 1) * s) * t
    )  # fmt: skip


@pytest.mark.parametrize("tool", TOOLS)
@pytest.mark.parametrize("direction", DIRECTIONS, ids=lambda d: np.round(d, 2).tolist())
def test_a_beacon_shines_from_where_it_was(tool, direction):
    to, back, lookup, name = TOOLS[tool]
    envmap = beacon(direction)
    seen = looked_up(to(envmap), *lookup(SPHERE))
    total = seen.T @ SOLID_ANGLES
    centroid = SPHERE @ (seen[:, 0] * SOLID_ANGLES)
    assert angle_between(centroid, np.array(name(*direction))) < HALF_PIXEL / 4
    if to in (to_mitsuba, to_openexr_latlong):
        # Resampled: what the tool integrates is the energy there was.
        np.testing.assert_allclose(total, energy(envmap.radiance), rtol=1e-3)
    returned = back(to(envmap))
    assert angle_between(light_vector(returned.radiance), direction) < HALF_PIXEL / 4
    np.testing.assert_allclose(energy(returned.radiance), energy(envmap.radiance), rtol=1e-5)


@pytest.mark.parametrize("tool", ["skylibs", "blender", "threejs"])
def test_the_same_pixels_come_back_exactly(tool):
    to, back, _, _ = TOOLS[tool]
    envmap = beacon(DIRECTIONS[5])
    returned = back(to(envmap), frame=Frame.WORLD)
    np.testing.assert_array_equal(returned.radiance, envmap.radiance)
    assert returned.frame is Frame.WORLD


@pytest.mark.parametrize("tool", ["mitsuba", "openexr"])
@pytest.mark.parametrize("height", [8, 9, 64, 511])
def test_resampling_keeps_constants_and_the_energy_of_a_pixel_sun(tool, height):
    to, back, _, _ = TOOLS[tool]
    flat = EnvironmentMap(radiance=np.full((height, 2 * height, 3), 3.25, np.float32))
    np.testing.assert_allclose(to(flat), 3.25, rtol=1e-5)
    for row in (0, 1, height // 2, height - 1):
        radiance = np.full((height, 2 * height, 3), 0.5, np.float32)
        radiance[row, 3] = 1e6
        sun = EnvironmentMap(radiance=radiance)
        np.testing.assert_allclose(energy(back(to(sun)).radiance), energy(radiance), rtol=1e-5)
        assert to(sun).min() >= 0.4999


def test_openexr_repeats_the_seam_and_mitsuba_its_borders():
    envmap = beacon(DIRECTIONS[3])
    latlong = to_openexr_latlong(envmap)
    np.testing.assert_array_equal(latlong[:, 0], latlong[:, -1])
    rows, padded = to_mitsuba(envmap), mitsuba_parameter(envmap)
    assert padded.shape == (HEIGHT, 2 * HEIGHT + 2, 3)
    np.testing.assert_array_equal(padded[:, 1:-1], rows)
    np.testing.assert_array_equal(padded[:, 0], rows[:, -1])
    np.testing.assert_array_equal(padded[:, -1], rows[:, 0])
    np.testing.assert_array_equal(from_mitsuba(padded).radiance, from_mitsuba(rows).radiance)


def test_blender_takes_a_flat_list_of_rgba():
    envmap = beacon(DIRECTIONS[1])
    pixels = to_blender(envmap)
    assert pixels.shape == (HEIGHT, 2 * HEIGHT, 4)
    assert (pixels[..., 3] == 1).all()
    np.testing.assert_array_equal(from_blender(pixels.ravel()).radiance, envmap.radiance)


def test_a_dome_light_turns_the_center_to_the_front():
    text = usd_dome_light("./probe.exr", intensity=2.5)
    assert text.startswith("#usda 1.0\n")
    assert "asset inputs:texture:file = @./probe.exr@" in text
    assert "inputs:intensity = 2.5" in text
    # USD's texture center is +Z; half a turn about Y makes it -Z, panokit's forward.
    assert "xformOp:rotateXYZ = (0, 180, 0)" in text
    assert text.count("{") == text.count("}") == 2
    for path in ("", "a@b.exr", "a\nb.exr"):
        with pytest.raises(UsageError):
            usd_dome_light(path)


@pytest.mark.parametrize("back", [entry[1] for entry in TOOLS.values()])
def test_arrays_that_are_no_map(back):
    for shape in ((16, 32), (16, 20, 3), (16, 32, 1), (0, 0, 3)):
        with pytest.raises(ImageError):
            back(np.ones(shape, np.float32))
    with pytest.raises(ImageError, match="finite"):
        back(np.full((16, 32, 3), np.nan, np.float32))
    with pytest.raises(ImageError, match=r"no RGBA picture|Expected|Mitsuba|lat-long"):
        from_blender(np.ones(77)) if back is from_blender else back(np.ones(77, np.float32))

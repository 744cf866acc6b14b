"""The USD stage, read by the words of its specification, and by USD itself where it is there."""

import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.io import read_exr, write_environment_map
from panokit.io.adapters import AnalyticSun, usd_dome_light
from tests.io.adapters.conftest import BRIGHT, direction_of

SUN = AnalyticSun(direction=np.array([0.6, 0.64, -0.48]), irradiance=np.array([3.0, 2.0, 1.0]))

# Runs wherever `pxr` is: PANOKIT_USD_PYTHON names a Python that has usd-core.
READ_BY_USD = """
import json, sys
try:
    from pxr import Usd, UsdGeom, UsdLux
except ImportError:
    sys.exit(9)
stage = Usd.Stage.Open(sys.argv[1])
cache = UsdGeom.XformCache()
def matrix(prim):
    return [list(row) for row in cache.GetLocalToWorldTransform(prim)]
dome = UsdLux.DomeLight.Get(stage, "/Light/Environment")
sun = UsdLux.DistantLight.Get(stage, "/Light/Sun")
print(json.dumps({
    "up": UsdGeom.GetStageUpAxis(stage),
    "root": str(stage.GetDefaultPrim().GetPath()),
    "dome": matrix(dome.GetPrim()),
    "texture": dome.GetTextureFileAttr().Get().resolvedPath,
    "format": dome.GetTextureFormatAttr().Get(),
    "sun": sun and {
        "matrix": matrix(sun.GetPrim()), "angle": sun.GetAngleAttr().Get(),
        "intensity": sun.GetIntensityAttr().Get(), "color": list(sun.GetColorAttr().Get()),
        "normalize": sun.GetNormalizeAttr().Get(),
    },
}))
"""


def shown(radiance, world_from_light, direction):
    """What a dome light shows in a direction of the world, by UsdLux and ImfEnvmap.h.

    Rows of a USD matrix are the images of the axes. Longitude is 0 at +Z and pi / 2 at +X, and
    pi at the left edge; latitude is pi / 2 at the upper edge.
    """
    x, y, z = np.linalg.inv(np.asarray(world_from_light)[:3, :3].T) @ direction
    longitude, latitude = np.arctan2(x, z), np.arcsin(y)
    height, width = radiance.shape[:2]
    column = int(np.floor((np.pi - longitude) / (2 * np.pi) * width)) % width
    row = min(int(np.floor((np.pi / 2 - latitude) / np.pi * height)), height - 1)
    return radiance[row, column]


def matrix_in(text):
    """The dome's matrix, from the one operation that its text has."""
    (angles,) = re.findall(r"float3 xformOp:rotateXYZ = \(([^)]*)\)", text)
    assert re.search(r'xformOpOrder = \["xformOp:rotateXYZ"\]', text)
    about_x, about_y, about_z = (float(angle) for angle in angles.split(","))
    assert about_x == about_z == 0
    c, s = np.cos(np.deg2rad(about_y)), np.sin(np.deg2rad(about_y))
    # The image of +X under a turn about +Y is (c, 0, -s).
    return np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])


def test_a_beacon_shines_from_where_it_was(beacon, texel, tmp_path):
    write_environment_map(beacon(*texel), tmp_path / "probe.exr")
    text = usd_dome_light("./probe.exr")
    assert 'upAxis = "Y"' in text
    assert "asset inputs:texture:file = @./probe.exr@" in text
    radiance, _ = read_exr(tmp_path / "probe.exr")
    seen = shown(radiance, matrix_in(text), direction_of(*texel))
    np.testing.assert_allclose(seen, BRIGHT)


def test_the_sun_shines_along_its_own_minus_z():
    text = usd_dome_light("p.exr", sun=SUN, intensity=2.0)
    rows = re.search(r"matrix4d xformOp:transform = \( (.*) \)", text)[1]
    matrix = np.array(re.findall(r"\(([^()]*)\)", rows))
    matrix = np.array([[float(v) for v in row.split(",")] for row in matrix])
    np.testing.assert_allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-8)
    np.testing.assert_allclose(np.linalg.det(matrix), 1)
    # It travels along the image of (0, 0, -1): away from where the sun is.
    np.testing.assert_allclose(-matrix[2, :3], -SUN.direction, atol=1e-8)
    assert "bool inputs:normalize = 1" in text
    assert "float inputs:intensity = 6\n" in text
    assert "float inputs:intensity = 2\n" in text
    assert "(1, 0.6666667, 0.3333333)" in text


@pytest.mark.parametrize("path", ["", "a@b.exr", "a\nb.exr"])
def test_a_path_that_usd_cannot_hold(path):
    with pytest.raises(UsageError):
        usd_dome_light(path)


@pytest.mark.tool
def test_usd_itself_reads_it_so(beacon, tmp_path):
    texel = (9, 50)
    write_environment_map(beacon(*texel), tmp_path / "probe.exr")
    (tmp_path / "probe.usda").write_text(usd_dome_light("./probe.exr", sun=SUN))
    python = os.environ.get("PANOKIT_USD_PYTHON", sys.executable)
    done = subprocess.run(
        [python, "-c", READ_BY_USD, str(tmp_path / "probe.usda")],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if done.returncode == 9:
        pytest.skip("there is no usd-core here")
    assert done.returncode == 0, done.stderr
    read = json.loads(done.stdout)
    assert (read["up"], read["root"], read["format"]) == ("Y", "/Light", "latlong")
    radiance, _ = read_exr(tmp_path / "probe.exr")
    assert read["texture"] == str(tmp_path / "probe.exr")
    np.testing.assert_allclose(shown(radiance, read["dome"], direction_of(*texel)), BRIGHT)
    sun = read["sun"]
    np.testing.assert_allclose(np.array(sun["matrix"])[2, :3], SUN.direction, atol=1e-7)
    assert sun["normalize"] is True
    np.testing.assert_allclose(sun["angle"], 0.5332, atol=1e-4)
    np.testing.assert_allclose(np.multiply(sun["color"], sun["intensity"]), SUN.irradiance, 1e-5)

"""The Blender script: its text, and what a real Blender makes of it where there is one."""

import ast
import json
import shutil
import subprocess

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.io import read_exr, write_environment_map
from panokit.io.adapters import AnalyticSun, blender_world_script
from tests.io.adapters.conftest import DIM, TEXELS, direction_of

SUN = AnalyticSun(direction=np.array([0.6, 0.64, -0.48]), irradiance=np.array([3.0, 2.0, 1.0]))

# Looks along each direction of the scene, +Y north and +Z up, and then straight at a white sheet
# that faces the sun. Every name here is Blender's own.
DRIVER = """
import bpy, json, runpy, sys
from mathutils import Vector
job = json.loads(sys.argv[-1])
for old in list(bpy.data.objects):
    bpy.data.objects.remove(old)
runpy.run_path(job["script"])
scene = bpy.context.scene
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
scene.camera = camera
camera.data.angle = job["fov"]
camera.rotation_mode = "QUATERNION"
scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = 4
scene.cycles.use_denoising = False
scene.render.filter_size = 0.01
scene.render.resolution_x = scene.render.resolution_y = job["pixels"]
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"

def shoot(toward, path):
    camera.rotation_quaternion = Vector(toward).to_track_quat("-Z", "Y")
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)

for number, toward in enumerate(job["views"]):
    shoot(toward, f"{job['out']}/view{number}.exr")
if job["sun"]:
    bpy.ops.mesh.primitive_plane_add(size=2)
    sheet = bpy.context.object
    material = bpy.data.materials.new("white")
    material.use_nodes = True
    material.node_tree.nodes.clear()
    matte = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    matte.inputs["Color"].default_value = (1, 1, 1, 1)
    output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(matte.outputs["BSDF"], output.inputs["Surface"])
    sheet.data.materials.append(material)
    sun = Vector(job["sun"])
    sheet.rotation_mode = "QUATERNION"
    sheet.rotation_quaternion = sun.to_track_quat("Z", "Y")
    sheet.location = -sun * 4
    scene.world = None
    scene.cycles.max_bounces = 0
    shoot(-sun, f"{job['out']}/sheet.exr")
"""


def in_scene(direction):
    """North is +Y, east +X, up +Z."""
    east, up, south = direction
    return [float(east), float(-south), float(up)]


def test_the_script_is_python_and_names_the_texture():
    text = blender_world_script("probe.exr", name="probe", script="probe.blender.py")
    ast.parse(text)
    assert "TEXTURE = 'probe.exr'" in text
    assert "SUN = None" in text
    assert "--python probe.blender.py" in text


def test_the_sun_of_the_script_is_in_the_scenes_axes():
    text = blender_world_script("probe.exr", name="probe", sun=SUN)
    value = next(
        ast.literal_eval(node.value)
        for node in ast.parse(text).body
        if isinstance(node, ast.Assign) and node.targets[0].id == "SUN"
    )
    np.testing.assert_allclose(value["toward"], in_scene(SUN.direction), atol=1e-6)
    np.testing.assert_allclose(
        np.multiply(value["color"], value["irradiance"]), SUN.irradiance, rtol=1e-6
    )
    np.testing.assert_allclose(np.rad2deg(value["angle"]), 0.5332, atol=1e-4)


def test_a_script_needs_a_texture():
    with pytest.raises(UsageError):
        blender_world_script("", name="x")


@pytest.mark.tool
def test_a_real_blender_shows_the_beacon_where_it_is_and_the_sun_as_strong_as_it_is(
    tmp_path, beacon
):
    blender = shutil.which("blender")
    if blender is None:
        pytest.skip("there is no Blender here")
    # One map with all beacons: Blender takes seconds to start.
    together = sum(beacon(*texel).radiance for texel in TEXELS) - DIM * (len(TEXELS) - 1)
    write_environment_map(
        beacon(*TEXELS[0]).with_changes(radiance=np.maximum(together, 0).astype(np.float32)),
        tmp_path / "probe.exr",
    )
    script = tmp_path / "probe.blender.py"
    script.write_text(blender_world_script("probe.exr", name="probe", sun=SUN))
    (tmp_path / "driver.py").write_text(DRIVER)
    pixels, fov = 33, np.deg2rad(33.0)
    job = {
        "script": str(script),
        "out": str(tmp_path),
        "pixels": pixels,
        "fov": fov,
        "views": [in_scene(direction_of(*texel)) for texel in TEXELS],
        "sun": in_scene(SUN.direction),
    }
    command = [blender, "-b", "--factory-startup", "-t", "1", "--python-exit-code", "3"]
    command += ["--python", str(tmp_path / "driver.py"), "--", json.dumps(job)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    for number in range(len(TEXELS)):
        picture, _ = read_exr(tmp_path / f"view{number}.exr")
        weight = np.maximum(picture[..., 0] - 2 * DIM, 0)
        rows, columns = np.mgrid[:pixels, :pixels] - pixels // 2
        offset = np.array([(weight * rows).sum(), (weight * columns).sum()]) / weight.sum()
        # A pixel is about a degree; half a texel of the map is 2.8.
        assert np.abs(offset).max() < 0.7, (TEXELS[number], offset)
        assert picture[pixels // 2, pixels // 2, 0] > 50
        # Not another color, and not encoded.
        np.testing.assert_allclose(picture[16, 16] / picture[16, 16, 0], [1, 0.5, 0.25], atol=0.02)
    # A white matte sheet that faces a light of irradiance E has the radiance E / pi.
    sheet, _ = read_exr(tmp_path / "sheet.exr")
    np.testing.assert_allclose(sheet[16, 16], SUN.irradiance / np.pi, rtol=0.01)

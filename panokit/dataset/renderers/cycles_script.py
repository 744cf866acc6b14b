"""Runs inside Blender, never inside panokit: renders the jobs that arrive as lines of JSON.

    blender -b --factory-startup --python cycles_script.py -- FOLDER
    python cycles_script.py -- FOLDER          (a Python that has the module bpy)

Each line on the standard input names a job in the folder: NAME.json with numbers and NAME.npz
with arrays. Each answer is a line that starts with "@panokit ". Pictures are left in the folder
as multi-layer EXR. Everything arrives in Blender's frame and conventions already.
"""

import json
import sys
import traceback
from pathlib import Path
from typing import Any

import bpy
import numpy as np

# The sockets of the principled shader were renamed in Blender 4.0.
NAMES_BEFORE_4 = {
    "specular": "Specular",
    "sheen": "Sheen",
    "clearcoat": "Clearcoat",
    "clearcoat_roughness": "Clearcoat Roughness",
}
NAMES_FROM_4 = {
    "specular": "Specular IOR Level",
    "sheen": "Sheen Weight",
    "clearcoat": "Coat Weight",
    "clearcoat_roughness": "Coat Roughness",
}
SAME_NAMES = {"metallic": "Metallic", "roughness": "Roughness"}
MOST_PARTS = 3


def set_up() -> None:
    """An empty scene with everything that stays from job to job."""
    for collection in (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.lights):
        for item in list(collection):
            collection.remove(item)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.film_transparent = True
    # Data kept from render to render would keep the pictures of the job before.
    scene.render.use_persistent_data = False
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.exr_codec = "NONE"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.light_sampling_threshold = 0
    cycles.pixel_filter_type = "BOX"
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = True
    layer.use_pass_material_index = layer.use_pass_diffuse_color = True
    _world(scene)
    for index in range(MOST_PARTS):
        _material(f"part{index}", index)
    floor = bpy.data.materials.new("floor")
    floor.use_nodes = True
    floor.node_tree.nodes.clear()
    shader = floor.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    output = floor.node_tree.nodes.new("ShaderNodeOutputMaterial")
    floor.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    camera.data.sensor_fit = "HORIZONTAL"
    camera.data.clip_start, camera.data.clip_end = 0.01, 1000
    scene.camera = camera


def _world(scene: Any) -> None:
    world = bpy.data.worlds.new("light")
    world.use_nodes = True
    # An automatic map is built anew for every change, which costs more than a second.
    world.cycles.sampling_method = "MANUAL"
    nodes = world.node_tree.nodes
    nodes.clear()
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.name = "map"
    background, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
    world.node_tree.links.new(picture.outputs["Color"], background.inputs["Color"])
    world.node_tree.links.new(background.outputs[0], output.inputs["Surface"])
    scene.world = world


def _material(name: str, index: int) -> None:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.pass_index = index + 1
    nodes = material.node_tree.nodes
    nodes.clear()
    shader, output = nodes.new("ShaderNodeBsdfPrincipled"), nodes.new("ShaderNodeOutputMaterial")
    shader.name, shader.distribution = "shader", "GGX"
    picture = nodes.new("ShaderNodeTexImage")
    picture.name, picture.interpolation = "texture", "Closest"
    material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])


def _image(name: str, pixels: np.ndarray) -> Any:
    """A float picture in Blender's memory, (H, W, 3) with row 0 at the top."""
    height, width = pixels.shape[:2]
    old = bpy.data.images.get(name)
    if old is not None:
        bpy.data.images.remove(old)
    image = bpy.data.images.new(name, width, height, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    whole = np.ones((height, width, 4), np.float32)
    whole[..., :3] = pixels[::-1]
    image.pixels.foreach_set(whole.ravel())
    image.update()
    return image


def fill(job: dict, arrays: Any) -> None:
    """Put the map, the triangles and the materials of a job into the scene."""
    scene = bpy.context.scene
    scene.world.node_tree.nodes["map"].image = _image("light", arrays["light"])
    # Finer than the map: light that is interpolated beside a sun must be met as often.
    finer = 2 * arrays["light"].shape[1]
    scene.world.cycles.sample_map_resolution = min(max(finer, 256), 1024)
    for name in ("object", "floor"):
        old = bpy.data.objects.get(name)
        if old is not None:
            mesh = old.data
            bpy.data.objects.remove(old)
            bpy.data.meshes.remove(mesh)
    materials = [bpy.data.materials[f"part{index}"] for index in range(MOST_PARTS)]
    corners = arrays["corners"]
    _add_mesh("object", corners, materials, arrays["part"], arrays["normals"], arrays["places"])
    if job["floor"] is not None:
        x, y, z, side = job["floor"]
        square = np.array([[-side, -side, 0], [side, -side, 0], [side, side, 0], [-side, side, 0]])
        square = np.add(square, [x, y, z])
        faces = square[[[0, 1, 2], [0, 2, 3]]]
        floor = _add_mesh("floor", faces, [bpy.data.materials["floor"]], np.zeros(2, np.int32))
        gray = [job["floor_albedo"]] * 3 + [1]
        floor.data.materials[0].node_tree.nodes["Diffuse BSDF"].inputs["Color"].default_value = gray
    names = NAMES_BEFORE_4 if bpy.app.version < (4, 0, 0) else NAMES_FROM_4
    for index, figures in enumerate(job["materials"]):
        tree = materials[index].node_tree
        shader = tree.nodes["shader"]
        for key, socket in {**SAME_NAMES, **names}.items():
            shader.inputs[socket].default_value = figures[key]
        color = shader.inputs["Base Color"]
        for link in list(color.links):
            tree.links.remove(link)
        color.default_value = [*figures["base_color"], 1]
        if f"texture{index}" in arrays:
            picture = tree.nodes["texture"]
            picture.image = _image(f"texture{index}", arrays[f"texture{index}"])
            tree.links.new(picture.outputs["Color"], color)


def _add_mesh(
    name: str,
    corners: np.ndarray,
    materials: list,
    part: np.ndarray,
    normals: np.ndarray | None = None,
    places: np.ndarray | None = None,
) -> Any:
    """Triangles (M, 3, 3), each with its own vertices."""
    count = len(corners)
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(3 * count)
    mesh.vertices.foreach_set("co", np.ascontiguousarray(corners, np.float32).ravel())
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", np.arange(3 * count, dtype=np.int32))
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    if bpy.app.version < (4, 0, 0):
        mesh.polygons.foreach_set("loop_total", np.full(count, 3, np.int32))
    for material in materials:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", np.ascontiguousarray(part, np.int32))
    mesh.update(calc_edges=True)
    if normals is not None:
        mesh.polygons.foreach_set("use_smooth", np.ones(count, bool))
        if hasattr(mesh, "use_auto_smooth"):
            mesh.use_auto_smooth = True
        mesh.normals_split_custom_set(normals.reshape(-1, 3).tolist())
    if places is not None:
        layer = mesh.uv_layers.new(name="box")
        layer.data.foreach_set("uv", np.ascontiguousarray(places, np.float32).ravel())
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def render(job: dict, folder: Path, name: str) -> list:
    """Render the passes of each view; the names of the files."""
    scene, files = bpy.context.scene, []
    camera, thing, floor = scene.camera, bpy.data.objects["object"], bpy.data.objects.get("floor")
    for view_number, view in enumerate(job["views"]):
        camera.matrix_world = np.array(view["matrix"]).T.tolist()
        if view["fov"] is None:
            camera.data.type, camera.data.ortho_scale = "ORTHO", 2.0
        else:
            camera.data.type, camera.data.angle_x = "PERSP", view["fov"]
        camera.data.shift_x = view["shift"]
        scene.render.resolution_x, scene.render.resolution_y = view["size"]
        # One ray through the middle of each pixel: an average over an edge is no normal.
        shots: list[tuple] = [("guides", 1, 0.01, True, False, False)]
        shots += [("beauty", job["samples"], 1.0, True, floor is not None, False)]
        if floor is not None:
            shots += [("both", job["samples"], 1.0, False, True, True)]
            shots += [("bare", job["samples"], 1.0, None, True, True)]
        for shot, samples, width, object_seen, floor_there, floor_seen in shots:
            if shot == "guides" and not view["guides"]:
                continue
            thing.hide_render, thing.visible_camera = object_seen is None, bool(object_seen)
            if floor is not None:
                floor.hide_render, floor.visible_camera = not floor_there, floor_seen
            cycles = scene.cycles
            cycles.samples, cycles.filter_width = samples, width
            cycles.seed = (job["seed"] + view_number) % 2**31
            bounces = 0 if shot in ("guides", "bare") else max(job["bounces"] - 1, 0)
            cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
            cycles.use_denoising = bool(job["denoise"]) and shot == "beauty"
            scene.render.filepath = str(folder / f"{name}-{view_number}-{shot}.exr")
            bpy.ops.render.render(write_still=True)
            files.append(scene.render.filepath)
    return files


def answer(value: dict) -> None:
    """One line to panokit."""
    sys.stdout.write("@panokit " + json.dumps(value) + "\n")
    sys.stdout.flush()


def main() -> None:
    """Answer jobs until the standard input ends."""
    folder = Path(sys.argv[sys.argv.index("--") + 1])
    set_up()
    denoise = True
    try:
        bpy.context.scene.cycles.denoiser = "OPENIMAGEDENOISE"
    except TypeError:
        denoise = False
    answer({"version": bpy.app.version_string, "denoise": denoise})
    for line in iter(sys.stdin.readline, ""):
        name = line.strip()
        if not name:
            continue
        try:
            job = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
            with np.load(folder / f"{name}.npz") as arrays:
                fill(job, dict(arrays))
            answer({"files": render(job, folder, name)})
        except Exception:
            answer({"error": traceback.format_exc()})


if __name__ == "__main__":
    main()

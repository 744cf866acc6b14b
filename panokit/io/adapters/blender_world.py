"""Blender: a script that lights the scene with a map, and with its sun where that is apart.

In the scene north is +Y, east +X and up +Z. The script keeps to what Blender has had since
2.93; it needs no add-on.
"""

from panokit.errors import UsageError
from panokit.io.adapters.analytic_sun import AnalyticSun

# An environment texture has +X at its center. The Mapping node turns the direction looked up, so
# that +Y, north, becomes +X.
_SCRIPT = '''"""Lights the open scene with {texture}.

Run it inside Blender: open it in the Text Editor and press Run Script, or on the command line
    blender scene.blend --python {script}
North is +Y, east +X, up +Z. To turn the light, change Z of the Mapping node's rotation.
"""

from math import radians
from pathlib import Path

import bpy
from mathutils import Vector

TEXTURE = {texture!r}
NAME = {name!r}
SUN = {sun}


def texture_path():
    here = [Path(__file__).parent, Path(__file__).parent.parent]
    here += [Path(bpy.path.abspath(text.filepath)).parent for text in bpy.data.texts]
    for folder in here:
        if (folder / TEXTURE).is_file():
            return folder / TEXTURE
    raise FileNotFoundError(f"{{TEXTURE}} is not beside this script; put it there.")


def linear(image):
    names = image.colorspace_settings.bl_rna.properties["name"].enum_items.keys()
    for name in ("Linear Rec.709", "Linear"):
        if name in names:
            image.colorspace_settings.name = name
            return


def light_scene(scene):
    image = bpy.data.images.load(str(texture_path()), check_existing=True)
    linear(image)
    world = bpy.data.worlds.new(NAME)
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    coordinates = nodes.new("ShaderNodeTexCoord")
    mapping = nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0, 0, radians(-90))
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    texture.projection = "EQUIRECTANGULAR"
    background = nodes.new("ShaderNodeBackground")
    output = nodes.new("ShaderNodeOutputWorld")
    links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    links.new(texture.outputs["Color"], background.inputs["Color"])
    links.new(background.outputs["Background"], output.inputs["Surface"])
    for place, node in enumerate((coordinates, mapping, texture, background, output)):
        node.location = (220 * place, 0)
    scene.world = world
    if SUN:
        lamp = bpy.data.lights.new(NAME + " sun", "SUN")
        lamp.energy, lamp.color, lamp.angle = SUN["irradiance"], SUN["color"], SUN["angle"]
        lit = bpy.data.objects.new(NAME + " sun", lamp)
        lit.rotation_mode = "QUATERNION"
        lit.rotation_quaternion = Vector(SUN["toward"]).to_track_quat("Z", "Y")
        scene.collection.objects.link(lit)


light_scene(bpy.context.scene)
'''


def blender_world_script(
    texture: str, *, name: str, script: str = "world.py", sun: AnalyticSun | None = None
) -> str:
    """The text of a Blender script that makes a map the scene's world.

    Args:
        texture: The map's file name; it is looked for beside the script.
        name: What the world is called in Blender.
        script: The script's own file name, for its instructions.
        sun: A sun lamp beside it, for a map without its sun.

    Raises:
        UsageError: If the file name is empty.
    """
    if not texture:
        raise UsageError("The script needs the file name of the map.")
    return _SCRIPT.format(texture=texture, name=name, script=script, sun=_sun_text(sun))


def _sun_text(sun: AnalyticSun | None) -> str:
    if sun is None:
        return "None"
    strength = max(float(sun.irradiance.max()), 1e-30)
    east, up, south = (float(value) for value in sun.direction)
    # The strength of a sun lamp is the irradiance of a surface that faces it.
    values = {
        "toward": (round(east, 7), round(-south, 7), round(up, 7)),
        "irradiance": float(f"{strength:.7g}"),
        "color": tuple(round(float(value) / strength, 7) for value in sun.irradiance),
        "angle": round(float(2 * sun.angular_radius), 7),
    }
    return repr(values)

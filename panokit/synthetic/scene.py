"""A built place and its sky as a Mitsuba scene.

Meshes go to Mitsuba through PLY files in a folder of the caller's; pictures go as arrays, never
as EXR files, which Mitsuba cannot read with a single thread.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from panokit.renderer import environment_emitter, load_mitsuba
from panokit.sphere import equirect_directions
from panokit.sun import SUN_RADIUS
from panokit.synthetic.materials import Material, Texture
from panokit.synthetic.shapes import Mesh
from panokit.synthetic.sky import SKY_WIDTH_PX, Sky
from panokit.synthetic.textures import paint

_SUN_DISTANCE_M = 6000.0


def load_scene(
    meshes: Mapping[Material, Mesh],
    sky: Sky,
    folder: Path,
    painted: dict[Texture, Any] | None = None,
) -> Any:
    """The Mitsuba scene of a place.

    Args:
        meshes: What stands there, in the world frame.
        sky: What lights it.
        folder: For files that Mitsuba reads at once; it may be deleted afterwards.
        painted: Pictures on surfaces from an earlier scene of the same place, to use again;
            new ones are added.
    """
    mitsuba = load_mitsuba()
    painted = {} if painted is None else painted
    scene: dict[str, Any] = {"type": "scene", "sky": environment_emitter(sky.radiance)}
    if sky.sun_direction is not None:
        scene["sun"] = _sun(sky)
    for index, (material, mesh) in enumerate(meshes.items()):
        path = folder / f"{index}.ply"
        write_ply(mesh, path)
        part: dict[str, Any] = {
            "type": "ply",
            "filename": str(path),
            "face_normals": not material.smooth,
            "bsdf": _shader(material, painted),
        }
        if material.glow is not None:
            part["emitter"] = _glow(material, painted)
        scene[f"part_{index}"] = part
    return mitsuba.load_dict(scene)


def clear_sky(sun_direction: np.ndarray, turbidity: float) -> Sky:
    """A cloudless sky with the sun in it: Hosek and Wilkie's, as Mitsuba implements it.

    Hosek and Wilkie 2012, "An Analytic Model for Full Spectral Sky-Dome Radiance". Radiance is
    scaled so that the mean of the upper half is about 1.
    """
    # The model's own frame is east, north, up.
    sun = [sun_direction[0], -sun_direction[2], max(sun_direction[1], 0.02)]
    model = {"type": "sunsky", "turbidity": turbidity, "albedo": 0.2, "sun_direction": sun}
    directions = equirect_directions(SKY_WIDTH_PX // 4, SKY_WIDTH_PX // 8).copy()
    directions[..., 1] = np.maximum(directions[..., 1], 0.004)
    sky = np.maximum(_seen(model | {"sun_scale": 0.0}, directions), 0)
    towards = np.asarray(sun_direction, np.float32).reshape(1, 1, 3)
    disk = np.maximum(_seen(model | {"sky_scale": 0.0}, towards), 0)[0, 0]
    scale = 1 / sky[: len(sky) // 2].mean()
    sky = _doubled(_doubled(sky * scale))
    half = sky.shape[0] // 2
    sky[half:] = 0.2 * sky[half - 8 : half].mean(axis=(0, 1))
    # The model gives the middle of the disk, which limb darkening makes brighter than the mean.
    return Sky(
        radiance=sky.astype(np.float32),
        sun_direction=np.asarray(sun_direction, np.float64),
        sun_radiance=disk.astype(np.float64) * float(scale) * 0.8,
    )


def _seen(model: dict[str, Any], directions: np.ndarray) -> np.ndarray:
    """The model's radiance in directions (h, w, 3) of panokit's frame."""
    mitsuba = load_mitsuba()
    emitter = mitsuba.load_dict(model)
    shape = directions.shape[:2]
    flat = directions.reshape(-1, 3)
    local = np.stack([flat[:, 0], -flat[:, 2], flat[:, 1]], 1)
    local /= np.linalg.norm(local, axis=1, keepdims=True)
    if mitsuba.variant().startswith("scalar"):
        values = [_seen_once(mitsuba, emitter, direction) for direction in local]
        return np.asarray(values).reshape(*shape, 3)
    interaction = mitsuba.SurfaceInteraction3f()
    interaction.wi = -mitsuba.Vector3f(local.T.astype(np.float32))
    return np.array(emitter.eval(interaction)).T.reshape(*shape, 3)


def _seen_once(mitsuba: Any, emitter: Any, direction: np.ndarray) -> np.ndarray:
    interaction = mitsuba.SurfaceInteraction3f()
    interaction.wi = mitsuba.Vector3f(*(-direction))
    return np.array(emitter.eval(interaction))


def _doubled(picture: np.ndarray) -> np.ndarray:
    """Twice the size, by linear interpolation between pixel centers, wrapped at the seam."""
    wide = np.concatenate([picture[:, -1:], picture, picture[:, :1]], axis=1)
    left, here, right = wide[:, :-2], wide[:, 1:-1], wide[:, 2:]
    columns = np.stack([0.75 * here + 0.25 * left, 0.75 * here + 0.25 * right], axis=2)
    columns = columns.reshape(picture.shape[0], -1, 3)
    above = np.concatenate([columns[:1], columns[:-1]])
    below = np.concatenate([columns[1:], columns[-1:]])
    rows = np.stack([0.75 * columns + 0.25 * above, 0.75 * columns + 0.25 * below], axis=1)
    return rows.reshape(-1, columns.shape[1], 3)


def _sun(sky: Sky) -> dict[str, Any]:
    mitsuba = load_mitsuba()
    place = np.asarray(sky.sun_direction) * _SUN_DISTANCE_M
    transform = mitsuba.ScalarTransform4f()
    facing = transform.look_at(place.tolist(), [0.0, 0.0, 0.0], [0.0123, 1.0, 0.0077])
    radiance = {"type": "rgb", "value": [float(value) for value in sky.sun_radiance]}
    return {
        "type": "disk",
        "to_world": facing @ transform.scale(_SUN_DISTANCE_M * float(np.tan(SUN_RADIUS))),
        "emitter": {"type": "area", "radiance": radiance},
        "bsdf": {"type": "diffuse", "reflectance": 0.0},
    }


def _shader(material: Material, painted: dict[Texture, Any]) -> dict[str, Any]:
    color = (
        {"type": "rgb", "value": list(material.color)}
        if material.texture is None
        else _bitmap(material.texture, painted)
    )
    surface: dict[str, Any] = {
        "type": "principled",
        "base_color": color,
        "roughness": material.roughness,
        "metallic": max(material.metallic, 1e-4),
        # A lobe of exactly zero would compile another kernel; see Mitsuba's principled plugin.
        "clearcoat": max(material.clearcoat, 1e-4),
        "clearcoat_gloss": 0.95,
        "specular": {"glass": 0.9, "water": 0.35, "solid": 0.4}[material.kind],
    }
    if material.kind == "water":
        surface = {"type": "bumpmap", "arbitrary": _waves(), "scale": 0.35, "nested": surface}
    return {"type": "twosided", "nested": surface}


def _waves() -> dict[str, Any]:
    ripples = paint(
        Texture(pattern="asphalt", seed=11, width_px=512, height_px=512, color=(0.4, 0.4, 0.4))
    )
    mitsuba = load_mitsuba()
    height = ripples[..., :1].astype(np.float32) / 255
    for shift in (1, 2, 4, 8):
        around = [np.roll(height, step, axis) for axis in (0, 1) for step in (shift, -shift)]
        height = np.mean(around, axis=0, dtype=np.float32)
    return {"type": "bitmap", "bitmap": mitsuba.Bitmap(height), "raw": True}


def _bitmap(texture: Texture, painted: dict[Texture, Any]) -> dict[str, Any]:
    mitsuba = load_mitsuba()
    if texture not in painted:
        painted[texture] = mitsuba.Bitmap(np.ascontiguousarray(paint(texture)))
    return {"type": "bitmap", "bitmap": painted[texture]}


def _glow(material: Material, painted: dict[Texture, Any]) -> dict[str, Any]:
    if material.glow is None or material.texture is None:
        return {"type": "area", "radiance": {"type": "rgb", "value": list(material.glow or ())}}
    mitsuba = load_mitsuba()
    linear = (paint(material.texture).astype(np.float32) / 255) ** 2.2
    lit = linear * np.array(material.glow, np.float32)
    picture = {"type": "bitmap", "bitmap": mitsuba.Bitmap(lit), "raw": True}
    return {"type": "area", "radiance": picture}


def write_ply(mesh: Mesh, path: Path) -> None:
    """Write a mesh as binary PLY with texture coordinates."""
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(mesh.vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property float u\nproperty float v\n"
        f"element face {len(mesh.triangles)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    vertices = np.concatenate([mesh.vertices, mesh.uv], axis=1).astype("<f4")
    faces = np.empty(len(mesh.triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, mesh.triangles
    path.write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())

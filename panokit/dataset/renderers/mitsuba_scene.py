"""One Mitsuba scene that is loaded once and then changed for every sample.

Loading a new scene for every sample costs time and memory, and may compile new kernels. Here
only the values of parameters change: triangles, materials, the map, the cameras. The number
and the types of things never do.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.materials import OFF, TEXTURE_PX
from panokit.dataset.objects.creases import corner_normals
from panokit.dataset.renderers.texturing import box_coordinates
from panokit.dataset.scene import Material, Mesh, View
from panokit.envmap import EnvironmentMap
from panokit.renderer import environment_emitter, environment_parameter, load_mitsuba
from panokit.sphere import resize_radiance

MOST_PARTS = 3
LIGHT_WIDTH_PX, BALL_LIGHT_WIDTH_PX = 512, 256
FLOOR_ALBEDO = 0.4
_FLOOR_SIDE_M = 40.0
_LOBES = ("roughness", "metallic", "sheen", "clearcoat", "clearcoat_gloss", "flatness")
# Below this a mirror-like lobe becomes a point that no random direction meets.
_SMOOTHEST = 0.03
_ALIGNMENT = 64


class LoadedScene:
    """A scene with slots for three parts, a map, perhaps a floor, and one camera at a time.

    Args:
        textured: Whether base colors are pictures; that makes every look-up dearer.
        floor: Whether there is a floor.
        ball: A unit sphere in place of the parts.
        bare: Nothing in place of the parts.
    """

    def __init__(
        self,
        *,
        textured: bool = False,
        floor: bool = False,
        ball: bool = False,
        bare: bool = False,
    ) -> None:
        mitsuba = load_mitsuba()
        self.floor = floor
        self._textured, self._ball = textured, ball
        self._light_width_px = BALL_LIGHT_WIDTH_PX if ball else LIGHT_WIDTH_PX
        black = np.zeros((self._light_width_px // 2, self._light_width_px, 3), np.float32)
        nodes: dict[str, Any] = {"type": "scene", "light": environment_emitter(black + 1)}
        if ball:
            nodes["part0"] = {"type": "sphere", "bsdf": self._surface()}
        elif not bare:
            for index in range(MOST_PARTS):
                nodes[f"part{index}"] = self._empty_mesh(f"part{index}")
        if floor:
            nodes["floor"] = {
                "type": "rectangle",
                "to_world": mitsuba.ScalarTransform4f(),
                "bsdf": {
                    "type": "diffuse",
                    "reflectance": {"type": "rgb", "value": FLOOR_ALBEDO},
                },
            }
        # Merging would make one node of parts that only later become different.
        self.scene = mitsuba.load_dict(nodes, optimize=False)
        self._parameters = mitsuba.traverse(self.scene)
        self._light: NDArray[np.float32] | None = None

    def _surface(self) -> dict[str, Any]:
        lobes = dict.fromkeys(_LOBES, 0.5)
        color: dict[str, Any] = {"type": "rgb", "value": [0.5, 0.5, 0.5]}
        if self._textured:
            picture = np.full((TEXTURE_PX, TEXTURE_PX, 3), 0.5, np.float32)
            color = {
                "type": "bitmap",
                "bitmap": load_mitsuba().Bitmap(picture),
                "raw": True,
                "filter_type": "nearest",
            }
        return {
            "type": "twosided",
            "material": {"type": "principled", "specular": 0.5, "base_color": color, **lobes},
        }

    def _empty_mesh(self, name: str) -> Any:
        mitsuba = load_mitsuba()
        properties = mitsuba.Properties()
        properties["bsdf"] = mitsuba.load_dict(self._surface())
        return mitsuba.Mesh(
            name, 3, 1, has_vertex_normals=True, has_vertex_texcoords=True, props=properties
        )

    def set_light(self, light: EnvironmentMap) -> None:
        """Light the scene with a map in the world's frame."""
        if light.radiance is self._light:
            return
        radiance = light.radiance
        if radiance.shape[1] != self._light_width_px:
            radiance = resize_radiance(radiance, self._light_width_px)
        self._parameters["light.data"] = environment_parameter(radiance)
        self._light = light.radiance

    def set_mesh(self, mesh: Mesh) -> None:
        """Put in the triangles, part by part; parts that the object lacks vanish."""
        corners = mesh.vertices[mesh.faces]
        normals, places = corner_normals(mesh), box_coordinates(mesh)
        for index in range(MOST_PARTS):
            mine = np.flatnonzero(mesh.part == index)
            if len(mine):
                self._set_triangles(index, corners[mine], normals[mine], places[mine])
            else:
                # One triangle without an area, at a place that is inside the object's bounds.
                nowhere = np.broadcast_to(mesh.vertices[0], (1, 3, 3))
                upward = np.broadcast_to(np.array([0, 1, 0], np.float32), (1, 3, 3))
                self._set_triangles(index, nowhere, upward, np.zeros((1, 3, 2), np.float32))

    def _set_triangles(
        self,
        index: int,
        corners: NDArray[np.float32],
        normals: NDArray[np.float32],
        places: NDArray[np.float32],
    ) -> None:
        faces = np.arange(3 * len(corners), dtype=np.uint32)
        values = {
            "vertex_positions": corners,
            "vertex_normals": normals,
            "vertex_texcoords": places,
            "faces": faces,
        }
        for name, array in values.items():
            key = f"part{index}.{name}"
            # The type of an array is another one in each variant.
            self._assign(key, type(self._parameters[key])(in_line(array)))

    def _assign(self, key: str, value: Any) -> None:
        """Set a parameter; the scalar variant cannot compare it with one of another length."""
        if not load_mitsuba().variant().startswith("scalar"):
            self._parameters[key] = value
            return
        place, kind, _, _ = self._parameters.properties[key]
        self._parameters.set_dirty(key)
        self._parameters.set_property(*((place,) if kind is None else (place, kind)), value)

    def set_floor(self, height_m: float, middle: NDArray[np.floating[Any]]) -> None:
        """Lay the floor level at this height, around a place."""
        transform = load_mitsuba().ScalarTransform4f
        self._parameters["floor.to_world"] = (
            transform().translate([float(middle[0]), height_m, float(middle[2])])
            @ transform().rotate([1, 0, 0], -90)
            @ transform().scale(_FLOOR_SIDE_M / 2)
        )

    def set_materials(self, materials: tuple[Material, ...]) -> None:
        """Give each part its material."""
        for index, material in enumerate(materials):
            root = f"part{index}.bsdf.brdf_0"
            for lobe in _LOBES:
                lowest = _SMOOTHEST if lobe == "roughness" else OFF
                self._parameters[f"{root}.{lobe}.value"] = _number(
                    max(getattr(material, lobe), lowest)
                )
            self._parameters[f"{root}.specular"] = _number(max(material.specular, OFF))
            if self._textured:
                self._parameters[f"{root}.base_color.data"] = _picture(material)
            else:
                color = [_number(value) for value in material.base_color]
                self._parameters[f"{root}.base_color.value"] = load_mitsuba().Color3f(*color)

    def update(self) -> None:
        """Let all changes take effect."""
        self._parameters.update()
        # Mitsuba 3.9 tells the map how large the scene is before it measures the scene anew, so
        # that shadow rays would be as long as the last sample's object needs.
        self.scene.parameters_changed([])


def _number(value: float) -> Any:
    """A number kept in memory: as a literal it would be compiled into the kernel."""
    mitsuba = load_mitsuba()
    if mitsuba.variant().startswith("scalar"):
        return value
    return mitsuba.Float(in_line(np.array([value], np.float32)))


def in_line(array: NDArray[Any]) -> NDArray[Any]:
    """A copy that is flat and starts at a multiple of 64 bytes.

    Mitsuba works on the memory of a numpy array where it lies, and compiles kernels for how it
    is aligned, which is a matter of luck.
    """
    size = array.nbytes
    room = np.empty(size + _ALIGNMENT, np.uint8)
    start = -room.ctypes.data % _ALIGNMENT
    copy = room[start : start + size].view(array.dtype)
    copy[:] = array.ravel()
    return copy


def _picture(material: Material) -> NDArray[np.float32]:
    """The texture of a material; Mitsuba has the first row at v = 0."""
    if material.texture is None:
        color = np.asarray(material.base_color, np.float32)
        return np.broadcast_to(color, (TEXTURE_PX, TEXTURE_PX, 3)).copy()
    return np.ascontiguousarray(material.texture[::-1])


class Camera:
    """A sensor of fixed size that is moved from view to view."""

    def __init__(
        self, width_px: int, height_px: int, *, kind: str, sampler: Mapping[str, Any]
    ) -> None:
        mitsuba = load_mitsuba()
        self.sensor = mitsuba.load_dict(
            {
                "type": kind,
                "near_clip": 0.01,
                "far_clip": 1000.0,
                "film": {
                    "type": "hdrfilm",
                    "width": width_px,
                    "height": height_px,
                    "pixel_format": "rgba",
                    "component_format": "float32",
                    "rfilter": {"type": "box"},
                },
                "sampler": dict(sampler),
            }
        )
        self._parameters = mitsuba.traverse(self.sensor)

    def aim(self, view: View) -> None:
        """Look where the view looks."""
        self._parameters["to_world"] = camera_matrix(
            view.world_from_camera.matrix, np.asarray(view.position)
        )
        self._parameters["x_fov"] = view.fov_deg
        # It says where the picture is cut out, so that the object moves the other way.
        self._parameters["principal_point_offset_x"] = -view.shift_px / view.width_px
        self._parameters.update()

    def aim_straight(self, distance_m: float) -> None:
        """Look along -Z at the unit square, for an orthographic camera."""
        self._parameters["to_world"] = camera_matrix(np.eye(3), np.array([0, 0, distance_m]))
        self._parameters.update()


def camera_matrix(axes: NDArray[Any], position: NDArray[Any]) -> Any:
    """Mitsuba's cameras look along their +Z with +X to the *left*; ours along -Z, +X right."""
    matrix = np.eye(4)
    matrix[:3, :3] = axes * np.array([-1.0, 1.0, -1.0])
    matrix[:3, 3] = position
    return load_mitsuba().AffineTransform4f(matrix.astype(np.float32))


@lru_cache(maxsize=8)
def loaded_scene(**things: bool) -> LoadedScene:
    """The scene of this process that has these things in it, see `LoadedScene`."""
    return LoadedScene(**things)

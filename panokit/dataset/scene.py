"""What is rendered: an object, its materials, the light around it and the cameras that look.

Everything lies in panokit's frame (+X right, +Y up, -Z forward), lengths in meters. The light
is infinitely far. A renderer takes a `Scene` and a `View` and gives back `ViewPasses`; it knows
nothing of samples, libraries or files.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.equirectangular import read_only
from panokit.errors import ImageError, UsageError
from panokit.frames import Rotation

Floats = NDArray[np.floating[Any]]
# What no ray hit lies this far away in a depth pass.
NO_DEPTH = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mesh:
    """Triangles of one object.

    Attributes:
        vertices: (N, 3) float32, meters; read-only.
        faces: (M, 3) int32, counter-clockwise seen from outside; read-only.
        part: (M,) uint8, which of the object's parts each triangle belongs to, from 0; parts
            are what different materials can be given to. Read-only.
        smooth: Whether normals are interpolated over the surface (vertices on a crease are
            doubled in that case); flat triangles otherwise.
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]
    part: NDArray[np.uint8]
    smooth: bool = False

    def __post_init__(self) -> None:
        vertices = np.ascontiguousarray(self.vertices, np.float32)
        faces = np.ascontiguousarray(self.faces, np.int32)
        part = np.ascontiguousarray(self.part, np.uint8)
        if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
            raise ImageError(
                f"A mesh has vertices (N, 3) and faces (M, 3), not {vertices.shape} and "
                f"{faces.shape}. Triangulate it.",
                reason="not-a-mesh",
            )
        if len(faces) == 0:
            raise ImageError(
                "The mesh has no faces. Export it with its surface, not as points.",
                reason="no-faces",
            )
        if not np.isfinite(vertices).all():
            raise ImageError(
                "The mesh has vertices that are not finite. Repair it in a modeling program.",
                reason="not-finite",
            )
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise ImageError(
                "The mesh has faces of vertices that it does not have. Export it again.",
                reason="bad-faces",
            )
        if part.shape != (len(faces),):
            raise UsageError(f"One part for each face: {len(faces)}, not {part.shape}.")
        object.__setattr__(self, "vertices", read_only(vertices))
        object.__setattr__(self, "faces", read_only(faces))
        object.__setattr__(self, "part", read_only(part))

    @property
    def bounds(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """The lowest and the highest corner, (3,) each."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @property
    def part_count(self) -> int:
        """How many parts there are."""
        return int(self.part.max()) + 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Material:
    """A principled surface; every figure lies in [0, 1].

    The model is that of Burley, "Physically Based Shading at Disney" (2012), as Mitsuba's
    `principled` and Blender's Principled BSDF have it.

    Attributes:
        base_color: Linear Rec.709 albedo.
        roughness: 0 is a mirror, 1 is chalk.
        metallic: 0 is a dielectric, 1 is a metal.
        specular: Strength of a dielectric's reflection; 0.5 is an index of refraction of 1.5.
        sheen: Of cloth, at grazing angles.
        clearcoat: A thin layer of varnish.
        clearcoat_gloss: How sharp it is.
        flatness: How much the surface looks as if light had traveled below it.
        texture: (H, W, 3) float32 linear albedo that takes the place of `base_color`, laid on
            by the box projection of the object's coordinates; or None.
    """

    base_color: tuple[float, float, float]
    roughness: float = 0.5
    metallic: float = 0.0
    specular: float = 0.5
    sheen: float = 0.0
    clearcoat: float = 0.0
    clearcoat_gloss: float = 1.0
    flatness: float = 0.0
    texture: NDArray[np.float32] | None = None

    def __post_init__(self) -> None:
        for name, value in self.to_json().items():
            if name != "texture" and not np.all(
                (np.asarray(value) >= 0) & (np.asarray(value) <= 1)
            ):
                raise UsageError(f"A material's {name} lies between 0 and 1, not at {value}.")

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`; of a texture only whether there is one."""
        names = [name for name in self.__slots__ if name != "texture"]
        return {name: getattr(self, name) for name in names} | {"texture": self.texture is not None}


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """A pinhole camera with square pixels.

    Attributes:
        name: "left" or "right".
        position: (x, y, z) of the center of projection, meters.
        world_from_camera: Its axes: right, up and back.
        fov_deg: From the left to the right edge, before any shift.
        width_px: Of the picture.
        height_px: Of the picture.
        shift_px: By how many columns the picture is moved to the right on the image plane
            (horizontal image translation); a point straight ahead then lies at the column
            `width_px / 2 + shift_px`.
    """

    name: str
    position: tuple[float, float, float]
    world_from_camera: Rotation
    fov_deg: float
    width_px: int
    height_px: int
    shift_px: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.fov_deg < 180:
            raise UsageError(f"A view is more than 0 and less than 180 wide, not {self.fov_deg}.")
        if self.width_px < 1 or self.height_px < 1:
            raise UsageError(f"A view has pixels, not {self.width_px}x{self.height_px}.")

    @property
    def focal_px(self) -> float:
        """The focal length in pixels."""
        return float(self.width_px / 2 / np.tan(np.deg2rad(self.fov_deg) / 2))

    def rays(self) -> NDArray[np.float64]:
        """(H, W, 3), the unit direction behind the center of each pixel, in the world."""
        column = np.arange(self.width_px) + 0.5 - self.width_px / 2 - self.shift_px
        row = self.height_px / 2 - np.arange(self.height_px) - 0.5
        x, y = np.meshgrid(column / self.focal_px, row / self.focal_px)
        local = np.stack([x, y, -np.ones_like(x)], axis=-1)
        local /= np.linalg.norm(local, axis=-1, keepdims=True)
        return np.asarray(self.world_from_camera.apply(local))

    def project(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Column and row (pixel edges at integers, so centers at a half) and depth of points.

        Args:
            points: (..., 3) in the world, in front of the camera.
        """
        local = self.world_from_camera.inverse.apply(np.asarray(points) - self.position)
        depth = -local[..., 2]
        column = self.width_px / 2 + self.shift_px + self.focal_px * local[..., 0] / depth
        row = self.height_px / 2 - self.focal_px * local[..., 1] / depth
        return column, row, depth

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`, with the intrinsics that others ask for."""
        center = (self.width_px / 2 + self.shift_px, self.height_px / 2)
        focal = self.focal_px
        return {
            "position_m": list(self.position),
            "world_from_camera": self.world_from_camera.matrix.tolist(),
            "fov_deg": self.fov_deg,
            "width_px": self.width_px,
            "height_px": self.height_px,
            "intrinsics_px": [[focal, 0, center[0]], [0, focal, center[1]], [0, 0, 1]],
        }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scene:
    """One object in the light of one map.

    Attributes:
        mesh: The object, where it stands.
        materials: One for each part of the mesh, in order.
        light: The map, in the world's frame. Its exposure is its own: a renderer gives
            radiance on the same scale.
        floor_m: The height of a level, gray, diffuse floor that catches the object's shadow, or
            None for an object that floats.
    """

    mesh: Mesh
    materials: tuple[Material, ...]
    light: EnvironmentMap
    floor_m: float | None = None

    def __post_init__(self) -> None:
        if len(self.materials) != self.mesh.part_count:
            raise UsageError(
                f"One material for each of the {self.mesh.part_count} parts, "
                f"not {len(self.materials)}."
            )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ViewPasses:
    """What one view shows of a scene.

    Attributes:
        radiance: (H, W, 3) float32 linear radiance of the object, on zero and already
            multiplied by coverage: over a background it is `radiance + (1 - coverage) * light`.
        coverage: (H, W) float32, how much of each pixel the object covers, 0 to 1.
        part: (H, W) uint8, the part seen at the pixel's center plus one; 0 where none is.
        normal: (H, W, 3) float32 shading normals in the camera's frame (+X right, +Y up, +Z
            toward the camera), of unit length wherever `part` is not 0, and 0 elsewhere.
        depth: (H, W) float32, meters along the view axis; `NO_DEPTH` where `part` is 0.
        albedo: (H, W, 3) float32, base color at the pixel's center; 0 where `part` is 0.
        shadow: (H, W, 3) float32, by what a floor's light is multiplied because the object
            stands there; None without a floor.
    """

    radiance: NDArray[np.float32]
    coverage: NDArray[np.float32]
    part: NDArray[np.uint8]
    normal: NDArray[np.float32]
    depth: NDArray[np.float32]
    albedo: NDArray[np.float32]
    shadow: NDArray[np.float32] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Quality:
    """How well a scene is rendered.

    Attributes:
        samples: Paths per pixel.
        bounces: How often light may be reflected on its way.
        denoise: Whether the noise is filtered out (Open Image Denoise).
    """

    samples: int = 64
    bounces: int = 4
    denoise: bool = False


class Renderer(Protocol):
    """Renders scenes. One is made per process and used for many scenes."""

    def describe(self) -> Mapping[str, Any]:
        """Name, version and variant, for records; the same for the same pixels."""
        ...

    def render(
        self, scene: Scene, views: tuple[View, ...], quality: Quality, seed: int
    ) -> tuple[ViewPasses, ...]:
        """The passes of each view; the same seed gives the same pixels."""
        ...

    def reflectance(
        self, material: Material, light: EnvironmentMap, quality: Quality, seed: int, width_px: int
    ) -> NDArray[np.float32]:
        """The dense reflectance map of a material.

        A sphere of the material in this light, from a camera infinitely far that looks along -Z
        of the light's frame: (width_px, width_px, 3) float32 linear radiance, row 0 at the top,
        the pixel at (x, y) in [-1, 1]^2 showing the normal (x, y, sqrt(1 - x^2 - y^2)); zero
        outside the circle.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneSource:
    """Whose work is in a scene, for credits.

    Attributes:
        id: Of the object or map.
        license: SPDX identifier, or a name of terms.
        attribution: The line to show.
    """

    id: str
    license: str
    attribution: str = ""
    details: Mapping[str, Any] = field(default_factory=dict)

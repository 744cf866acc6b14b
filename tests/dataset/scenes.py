"""Small scenes with known answers, for tests of renderers."""

import numpy as np

from panokit.dataset.objects.solids import Solids
from panokit.dataset.scene import Material, Mesh, Scene, View
from panokit.envmap import EnvironmentMap
from panokit.frames import Frame, Rotation, direction_from_azimuth_elevation
from panokit.sphere import equirect_directions

OFF = 1e-4
WHITE = Material(
    base_color=(1.0, 1.0, 1.0), roughness=0.5, specular=OFF, metallic=OFF, sheen=OFF,
    clearcoat=OFF, flatness=OFF,
)  # fmt: skip
GLOSSY = Material(
    base_color=(0.5, 0.3, 0.2), roughness=0.35, specular=0.6, metallic=OFF, sheen=OFF,
    clearcoat=OFF, flatness=OFF,
)  # fmt: skip


def ball(radius_m: float = 0.5) -> Mesh:
    """A smooth sphere."""
    solids, angle = Solids(), np.linspace(0, np.pi, 49)
    profile = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    profile[[0, -1], 0] = 0
    solids.lathe(0, profile, segments=96)
    return solids.mesh(longest_m=2 * radius_m)


def boxes(count: int = 3) -> Mesh:
    """Boxes side by side, each of them a part, the last one nearest to the camera."""
    solids = Solids()
    for index in range(count):
        solids.box(index, (index, 0, index * 0.3), (index + 0.8, 1, index * 0.3 + 0.5), 0.05)
    return solids.mesh()


def uniform_light(value: float = 1.0) -> EnvironmentMap:
    """The same radiance from everywhere."""
    return EnvironmentMap(radiance=np.full((32, 64, 3), value, np.float32), frame=Frame.WORLD)


def sun_light(azimuth_deg: float, elevation_deg: float = 20.0, sky: float = 0.2) -> EnvironmentMap:
    """A dim sky with a sun of five degrees."""
    directions = equirect_directions(256, 128)
    toward = direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(elevation_deg))
    radiance = np.full((128, 256, 3), sky, np.float32)
    radiance[directions @ toward > np.cos(np.deg2rad(2.5))] = (400, 380, 330)
    return EnvironmentMap(radiance=radiance, frame=Frame.WORLD)


def view(
    *,
    heading_deg: float = 0.0,
    pitch_deg: float = 0.0,
    side_m: float = 0.0,
    distance_m: float = 2.2,
    width_px: int = 48,
    **changes,
) -> View:
    """A camera that looks past the origin, `side_m` to the right of the axis."""
    turned = Rotation.from_heading_pitch_roll(np.deg2rad(heading_deg), np.deg2rad(pitch_deg))
    known = {
        "name": "left",
        "position": tuple(turned.apply(np.array([side_m, 0, distance_m]))),
        "world_from_camera": turned,
        "fov_deg": 40.0,
        "width_px": width_px,
        "height_px": width_px,
    }
    return View(**(known | changes))


def scene(
    mesh: Mesh, light: EnvironmentMap, *materials: Material, floor_m: float | None = None
) -> Scene:
    """The mesh in the first materials given, as many as it has parts."""
    return Scene(mesh=mesh, materials=materials[: mesh.part_count], light=light, floor_m=floor_m)


def masked_mean(radiance, coverage) -> np.ndarray:
    """The mean radiance of the object where it is seen, (3,)."""
    return radiance.sum(axis=(0, 1)) / coverage.sum()

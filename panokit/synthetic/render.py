"""Panoramic rendering: the radiance that arrives at the camera from every direction.

Mitsuba has no panoramic camera, so a small one is defined here. The light that reaches the
camera straight from a source is rendered apart from the light that bounced: the denoiser
changes bright sources, and the sun is put in from its known place, size and radiance.
"""

from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import MissingExtraError
from panokit.frames import Rotation
from panokit.renderer import load_mitsuba
from panokit.sphere import equirect_directions
from panokit.sun import SUN_RADIUS, SUN_SOLID_ANGLE
from panokit.synthetic.sky import Sky

Picture = NDArray[np.float32]
# Sunlight that comes by way of a mirror-like pane meets one path in thousands.
_BRIGHTEST_BOUNCE = 40.0
_PAD_PX = 32
_MOST_RAYS = 1 << 23
_GUIDE_SAMPLES = 6
# Edges against the sky are not denoised, and rays without a bounce are cheap.
_EDGE_OVERSAMPLING = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class View:
    """A panoramic camera.

    Attributes:
        position_m: (3,) in the world frame.
        world_from_camera: How it is turned; identity for the world frame itself.
        width_px: Of the picture; it is half as high.
        samples: Light paths through each pixel.
        depth: Most bounces of a path.
        denoise: Whether to clean up what the paths leave noisy.
    """

    position_m: tuple[float, float, float]
    world_from_camera: Rotation
    width_px: int
    samples: int
    depth: int = 5
    denoise: bool = True


def render_radiance(scene: Any, sky: Sky, view: View, seed: int) -> Picture:
    """What the camera sees, (width / 2, width, 3) float32 linear radiance in its own frame."""
    mitsuba = load_mitsuba()
    sensor = _sensor(view)
    full = mitsuba.load_dict({"type": "path", "max_depth": view.depth, "rr_depth": 99})
    emitted = mitsuba.load_dict({"type": "path", "max_depth": 1})
    direct = np.zeros((view.width_px // 2, view.width_px, 3), np.float32)
    bounced = np.zeros_like(direct)
    for index, count in enumerate(_passes(view, view.samples)):
        # The same seed gives both the same rays, so their difference is what bounced.
        rays = {"sensor": sensor, "spp": count, "seed": _seed(seed, index)}
        seen = np.array(mitsuba.render(scene, integrator=emitted, **rays))
        whole = np.array(mitsuba.render(scene, integrator=full, **rays))
        direct += seen * count
        bounced += np.clip(np.nan_to_num(whole - seen), 0, _BRIGHTEST_BOUNCE) * count
    extra = view.samples * (_EDGE_OVERSAMPLING - 1)
    for index, count in enumerate(_passes(view, extra)):
        rays = {"sensor": sensor, "spp": count, "seed": _seed(seed, 2000 + index)}
        direct += np.array(mitsuba.render(scene, integrator=emitted, **rays)) * count
    direct /= view.samples + extra
    bounced /= view.samples
    if view.denoise:
        bounced = _denoised(scene, sensor, bounced, seed)
    return _with_sun(scene, direct, sky, view) + bounced


def _passes(view: View, samples: int) -> list[int]:
    """Samples in each pass: few passes, as each costs seconds to set up, in bounded memory."""
    at_once = max(1, _MOST_RAYS // (view.width_px * view.width_px // 2))
    whole, rest = divmod(samples, at_once)
    return [at_once] * whole + ([rest] if rest else [])


@lru_cache(maxsize=1)
def _register_sensor() -> str:
    mitsuba = load_mitsuba()
    import drjit

    class EquirectSensor(mitsuba.Sensor):  # type: ignore[name-defined]
        def __init__(self, props: Any) -> None:
            super().__init__(props)
            matrix = np.array(props["to_world"].matrix, np.float64).reshape(4, 4)
            self.axes = [mitsuba.ScalarVector3f(*matrix[:3, column]) for column in range(3)]
            self.origin = mitsuba.ScalarPoint3f(*matrix[:3, 3])

        def sample_ray(
            self, time: Any, wavelength: Any, position: Any, aperture: Any, active: Any = True
        ) -> Any:
            """A ray through a place in the picture, (0, 0) at the upper left."""
            sin_polar, cos_polar = drjit.sincos(position.y * drjit.pi)
            sin_turn, cos_turn = drjit.sincos((position.x - 0.5) * (2 * drjit.pi))
            right, up, backward = (mitsuba.Vector3f(axis) for axis in self.axes)
            direction = (
                right * (sin_polar * sin_turn) + up * cos_polar - backward * (sin_polar * cos_turn)
            )
            ray = mitsuba.Ray3f(mitsuba.Point3f(self.origin), direction, time, [])
            return ray, mitsuba.Color3f(1.0)

        def sample_ray_differential(
            self, time: Any, wavelength: Any, position: Any, aperture: Any, active: Any = True
        ) -> Any:
            """The same ray; the textures here need no differentials."""
            ray, weight = self.sample_ray(time, wavelength, position, aperture, active)
            ray = mitsuba.RayDifferential3f(ray)
            ray.has_differentials = False
            return ray, weight

    mitsuba.register_sensor("panokit_equirect", EquirectSensor)
    return "panokit_equirect"


def _sensor(view: View) -> Any:
    mitsuba = load_mitsuba()
    pose = np.eye(4)
    pose[:3, :3] = view.world_from_camera.matrix
    pose[:3, 3] = view.position_m
    return mitsuba.load_dict(
        {
            "type": _register_sensor(),
            "to_world": mitsuba.ScalarTransform4f(pose),
            "film": {
                "type": "hdrfilm",
                "width": view.width_px,
                "height": view.width_px // 2,
                "rfilter": {"type": "box"},
                "pixel_format": "rgb",
                "component_format": "float32",
            },
            "sampler": {"type": "independent"},
        }
    )


def _denoised(scene: Any, sensor: Any, noisy: Picture, seed: int) -> Picture:
    mitsuba = load_mitsuba()
    oidn = _load_denoiser()
    guides = mitsuba.load_dict({"type": "aov", "aovs": "albedo:albedo,normal:sh_normal"})
    guide = np.zeros((*noisy.shape[:2], 6), np.float32)
    for index in range(_GUIDE_SAMPLES):
        rendered = mitsuba.render(
            scene, sensor=sensor, integrator=guides, spp=1, seed=_seed(seed, 3000 + index)
        )
        guide += np.nan_to_num(np.array(rendered)[..., -6:]) / _GUIDE_SAMPLES
    # Padded across the seam, so that the cleaned picture still joins.
    color, albedo, normal = (
        np.ascontiguousarray(np.pad(part, ((0, 0), (_PAD_PX, _PAD_PX), (0, 0)), mode="wrap"))
        for part in (noisy, np.clip(guide[..., :3], 0, 1), guide[..., 3:])
    )
    cleaned = oidn.denoise(color, albedo, normal, hdr=True)
    return np.maximum(np.asarray(cleaned)[:, _PAD_PX:-_PAD_PX], 0).astype(np.float32)


def _load_denoiser() -> Any:
    if find_spec("mitsuba_oidn") is None:
        raise MissingExtraError("mitsuba_oidn", "render", "Denoising")
    # By name, because mypy cannot parse this package's own stubs.
    return import_module("mitsuba_oidn")


def _with_sun(scene: Any, direct: Picture, sky: Sky, view: View) -> Picture:
    """Take out the sun as the paths met it, and put it in with its exact energy."""
    if sky.sun_direction is None:
        return direct
    sun = view.world_from_camera.inverse.apply(np.asarray(sky.sun_direction))
    height, width = direct.shape[:2]
    directions = equirect_directions(width, height)
    reach = SUN_RADIUS + 2.5 * np.pi / height
    near = directions @ sun.astype(np.float32) > np.cos(reach)
    ring = (directions @ sun.astype(np.float32) > np.cos(2 * reach)) & ~near
    # Where a wall or a leaf hides the sun the paths met no more than the sky there.
    around = direct[ring].max(axis=0) if ring.any() else np.zeros(3)
    cleaned = direct.copy()
    cleaned[near] = np.minimum(cleaned[near], around)
    visible = _sun_visibility(scene, sky, view)
    cleaned += sun_picture(sun, width) * (sky.sun_radiance * visible).astype(np.float32)
    return cleaned


def sun_picture(direction: NDArray[np.floating[Any]], width_px: int) -> Picture:
    """How much of each pixel a disk of the sun's size covers, (H, W, 1).

    Scaled so that the sum over the picture, weighted with solid angles, is exactly the sun's.
    """
    height = width_px // 2
    directions = equirect_directions(width_px, height)
    reach = SUN_RADIUS + 2 * np.pi / height
    rows, columns = np.nonzero(directions @ direction.astype(np.float32) > np.cos(reach))
    parts = (np.arange(16) + 0.5) / 16
    polar = (rows[:, None, None] + parts[None, :, None]) / height * np.pi
    turn = ((columns[:, None, None] + parts[None, None, :]) / width_px - 0.5) * 2 * np.pi
    cosine = (
        np.sin(polar) * np.sin(turn) * direction[0]
        + np.cos(polar) * direction[1]
        - np.sin(polar) * np.cos(turn) * direction[2]
    )
    share = (cosine > np.cos(SUN_RADIUS)).mean(axis=(1, 2))
    edge = np.cos(np.pi * np.stack([rows, rows + 1]) / height)
    solid_angle = (edge[0] - edge[1]) * 2 * np.pi / width_px
    covered = np.zeros((height, width_px, 1), np.float32)
    total = float((share * solid_angle).sum())
    if total > 0:
        covered[rows, columns, 0] = share * (SUN_SOLID_ANGLE / total)
    else:
        nearest = int(np.argmax(directions.reshape(-1, 3) @ direction))
        row = nearest // width_px
        one = (np.cos(np.pi * row / height) - np.cos(np.pi * (row + 1) / height)) * 2 * np.pi
        covered.reshape(-1)[nearest] = SUN_SOLID_ANGLE / (one / width_px)
    return covered


def _sun_visibility(scene: Any, sky: Sky, view: View) -> float:
    """The share of the sun's disk that the camera sees."""
    mitsuba = load_mitsuba()
    toward = np.asarray(sky.sun_direction, np.float64)
    side = np.cross(toward, [0.0123, 1.0, 0.0077])
    side /= np.linalg.norm(side)
    other = np.cross(side, toward)
    # Sunflower points: even over the disk, and always the same.
    index = np.arange(64) + 0.5
    radius, angle = np.tan(SUN_RADIUS) * np.sqrt(index / 64), index * 2.399963
    origin = mitsuba.Point3f(*(float(value) for value in view.position_m))
    free = 0
    for r, a in zip(radius, angle, strict=True):
        direction = toward + r * (np.cos(a) * side + np.sin(a) * other)
        direction /= np.linalg.norm(direction)
        ray = mitsuba.Ray3f(origin, mitsuba.Vector3f(*direction.tolist()))
        # The disk of the sun itself stands 6000 m away; everything else is nearer.
        ray.maxt = 5000.0
        free += not np.array(scene.ray_test(ray)).any()
    return free / 64


def _seed(seed: int, index: int) -> int:
    """Of one rendering of a view; Mitsuba takes 32 bits."""
    return (seed * 4096 + index) % 2**32

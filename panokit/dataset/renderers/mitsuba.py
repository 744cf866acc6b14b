"""Renders with Mitsuba 3 on one thread: one scene per process, changed from sample to sample.

Radiance and coverage are path-traced. Normals, depth, albedo and parts come from one ray
through each pixel's center, as an average over a silhouette would be none of these. A floor is
rendered with the object and without; the ratio of the two is the shadow.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from panokit.dataset.renderers.mitsuba_paths import touched_pixels, trace
from panokit.dataset.renderers.mitsuba_scene import (
    MOST_PARTS,
    Camera,
    LoadedScene,
    loaded_scene,
)
from panokit.dataset.scene import NO_DEPTH, Material, Quality, Scene, View, ViewPasses
from panokit.envmap import EnvironmentMap
from panokit.errors import MissingExtraError, UsageError
from panokit.renderer import load_mitsuba, use_one_thread

VERSION = "1"
Picture = NDArray[np.float32]
# Strata that are jittered in many dimensions: less noise than independent numbers.
_SAMPLER = {"type": "multijitter"}
_CENTER = {"type": "stratified", "jitter": False, "sample_count": 1}
_GUIDES = "normal:sh_normal,flat:geo_normal,place:position,albedo:albedo,part:shape_index"
_FAR_M = 10.0
# Dim paths are given up at random from this bounce on: an eighth of the work less.
_ROULETTE = 2


class MitsubaRenderer:
    """Renders with Mitsuba 3; see the module.

    Raises:
        MissingExtraError: If Mitsuba is not installed.
        PanokitError: If no variant of it works here.
    """

    def __init__(self) -> None:
        self._mitsuba = load_mitsuba()
        use_one_thread()

    def describe(self) -> Mapping[str, Any]:
        """Name, version and variant."""
        return {
            "name": "mitsuba",
            "version": self._mitsuba.__version__,
            "variant": self._mitsuba.variant(),
            "recipe": VERSION,
        }

    def render(
        self, scene: Scene, views: tuple[View, ...], quality: Quality, seed: int
    ) -> tuple[ViewPasses, ...]:
        """The passes of each view.

        Raises:
            UsageError: If there are more than three materials.
            MissingExtraError: If noise is to be filtered and mitsuba-oidn is not installed.
        """
        if len(scene.materials) > MOST_PARTS:
            raise UsageError(f"Up to {MOST_PARTS} materials, not {len(scene.materials)}.")
        textured = any(material.texture is not None for material in scene.materials)
        alone = _filled(loaded_scene(textured=textured), scene)
        standing = None
        if scene.floor_m is not None:
            standing = _filled(loaded_scene(textured=textured, floor=True), scene)
        return tuple(
            self._passes(alone, standing, scene, view, quality, (2 * seed + index) % 2**32)
            for index, view in enumerate(views)
        )

    def reflectance(
        self, material: Material, light: EnvironmentMap, quality: Quality, seed: int, width_px: int
    ) -> Picture:
        """A path-traced sphere; a texture counts by its mean color."""
        ball = loaded_scene(ball=True)
        ball.set_light(light)
        ball.set_materials((material,))
        ball.update()
        camera = _camera(width_px, width_px, "orthographic")
        camera.aim_straight(_FAR_M)
        # A sphere does not see itself: light is reflected once.
        across = (np.arange(width_px) + 0.5) / width_px * 2 - 1
        inside = across**2 + across[:, None] ** 2 < 1
        seen = trace(ball.scene, camera, _integrator(1), quality.samples, seed % 2**32, inside)
        whole = seen[..., :3] / np.maximum(seen[..., 3:], 1e-6)
        return np.where(inside[..., None], whole, 0).astype(np.float32)

    def _passes(
        self,
        alone: LoadedScene,
        standing: LoadedScene | None,
        scene: Scene,
        view: View,
        quality: Quality,
        seed: int,
    ) -> ViewPasses:
        camera = _camera(view.width_px, view.height_px, "perspective")
        camera.aim(view)
        guides = self._guides(alone, scene, view)
        paths = (camera, _integrator(quality.bounces), quality.samples, seed)
        touched = touched_pixels(scene.mesh, view)
        shadow = None
        if standing is None or scene.floor_m is None:
            traced = trace(alone.scene, *paths, touched)
            radiance, coverage = traced[..., :3], traced[..., 3]
        else:
            everywhere = np.ones_like(touched)
            coverage = trace(alone.scene, camera, _integrator(0), *paths[2:], touched)[..., 3]
            both = trace(standing.scene, *paths, everywhere)
            empty = loaded_scene(floor=True, bare=True)
            _lay_floor(empty, scene)
            empty.set_light(scene.light)
            empty.update()
            bare = trace(empty.scene, camera, _integrator(1), *paths[2:], everywhere)
            shadow, behind = _shadow(both, bare, coverage)
            radiance = np.maximum(both[..., :3] - behind * (1 - coverage[..., None]), 0)
            radiance[coverage == 0] = 0
        if quality.bounces == 0:
            radiance = np.zeros_like(radiance)
        elif quality.denoise:
            radiance = _denoised(radiance, guides)
            radiance[coverage == 0] = 0
        return ViewPasses(
            radiance=np.ascontiguousarray(radiance),
            coverage=np.clip(coverage, 0, 1),
            shadow=shadow,
            **guides,
        )

    def _guides(self, scene: LoadedScene, what: Scene, view: View) -> dict[str, NDArray[Any]]:
        """Part, normal, depth and albedo at the centers of pixels."""
        camera = _camera(view.width_px, view.height_px, "perspective", centered=True)
        camera.aim(view)
        seen = np.array(
            self._mitsuba.render(
                scene.scene, sensor=camera.sensor, integrator=_guide_integrator(), spp=1, seed=0
            )
        )[..., -13:]
        normal, flat, place, albedo = (seen[..., k : k + 3] for k in (0, 3, 6, 9))
        there = np.linalg.norm(flat, axis=-1) > 0.5
        toward = np.asarray(view.position) - place
        # The back of an open surface shows its other side.
        behind = np.einsum("hwi,hwi->hw", flat, toward) < 0
        normal = np.where(behind[..., None], -normal, normal)
        normal = view.world_from_camera.inverse.apply(normal.astype(np.float64))
        normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
        _, _, depth = view.project(place.astype(np.float64))
        # Shapes are numbered from one, in the order in which they were loaded.
        part = np.rint(seen[..., 12]).astype(np.uint8)
        return {
            "part": np.where(there, part, 0).astype(np.uint8),
            "normal": np.where(there[..., None], normal, 0).astype(np.float32),
            "depth": np.where(there, depth, NO_DEPTH).astype(np.float32),
            "albedo": np.where(there[..., None], albedo, 0).astype(np.float32),
        }


def _filled(loaded: LoadedScene, scene: Scene) -> LoadedScene:
    loaded.set_light(scene.light)
    loaded.set_mesh(scene.mesh)
    loaded.set_materials(scene.materials)
    if scene.floor_m is not None and loaded.floor:
        _lay_floor(loaded, scene)
    loaded.update()
    return loaded


def _lay_floor(loaded: LoadedScene, scene: Scene) -> None:
    low, high = scene.mesh.bounds
    loaded.set_floor(float(scene.floor_m or 0.0), (low + high) / 2)


def _shadow(both: Picture, bare: Picture, coverage: Picture) -> tuple[Picture, Picture]:
    """What is left of the floor's light, and the floor's radiance also behind the object."""
    floor = (bare[..., 3] > 0) & (coverage == 0)
    ratio = np.ones_like(both[..., :3])
    np.divide(
        both[..., :3], bare[..., :3], out=ratio, where=(floor[..., None]) & (bare[..., :3] > 0)
    )
    behind = both[..., :3].copy()
    if floor.any():
        # Behind an edge the floor is as bright as at the nearest place where it is seen whole.
        _, (row, column) = distance_transform_edt(~floor, return_indices=True)
        behind, ratio = behind[row, column], np.where(floor[..., None], ratio, ratio[row, column])
        horizon = bare[..., 3:]
        behind = behind * horizon
        ratio = 1 + (ratio - 1) * horizon
    return np.clip(ratio, 0, 1).astype(np.float32), behind.astype(np.float32)


def _denoised(radiance: Picture, guides: Mapping[str, NDArray[Any]]) -> Picture:
    try:
        import mitsuba_oidn
    except ImportError as error:
        raise MissingExtraError("mitsuba-oidn", "render", "Filtering noise") from error
    filtered = mitsuba_oidn.denoise(
        np.ascontiguousarray(radiance),
        np.ascontiguousarray(np.clip(guides["albedo"], 0, 1)),
        np.ascontiguousarray(guides["normal"]),
        hdr=True,
        clean_aux=True,
    )
    return np.maximum(np.array(filtered, np.float32), 0)


@lru_cache(maxsize=8)
def _camera(width_px: int, height_px: int, kind: str, centered: bool = False) -> Camera:
    return Camera(width_px, height_px, kind=kind, sampler=_CENTER if centered else _SAMPLER)


@lru_cache(maxsize=8)
def _integrator(bounces: int) -> Any:
    mitsuba = load_mitsuba()
    # The scalar variant sees nothing, not even that something is there, without a bounce.
    bounces = max(bounces, 1 if mitsuba.variant().startswith("scalar") else 0)
    return mitsuba.load_dict(
        {"type": "path", "max_depth": bounces + 1, "rr_depth": _ROULETTE, "hide_emitters": True}
    )


@lru_cache(maxsize=1)
def _guide_integrator() -> Any:
    return load_mitsuba().load_dict({"type": "aov", "aovs": _GUIDES})

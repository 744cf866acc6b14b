"""A tiny renderer of formulas, for tests and machines without Mitsuba.

The mesh is seen through a z-buffer. Its diffuse part takes the irradiance of the map, which is
exact for a convex object; its mirroring part takes the map blurred as wide as the lobe of the
roughness (J. Wang et al., "All-frequency rendering of dynamic, spatially-varying reflectance",
2009). The object does not shade or mirror itself. Without a floor a 64x64 view takes some tens
of milliseconds, and nothing is random.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.objects.creases import corner_normals, face_normals
from panokit.dataset.renderers.raster import Hits, look, rasterize
from panokit.dataset.renderers.texturing import box_coordinates, texture_at
from panokit.dataset.scene import NO_DEPTH, Material, Quality, Scene, View, ViewPasses
from panokit.envmap import EnvironmentMap
from panokit.sphere import blur_radiance, irradiance_map, light_parcels, resize_radiance, sample

Floats = NDArray[np.floating[Any]]
VERSION = "1"
# Odd, so that one of the points lies at the pixel's center.
_OVERSAMPLING = 3
# Roughness of the blurred maps that a lobe is mixed from.
_LEVELS = (0.1, 0.3, 0.45, 0.6, 0.8, 1.0)
_MAP_WIDTH_PX = 128
# Directions of light whose shadows are drawn on the floor, of 16x8 over the sphere.
_SHADOWS = 16
_SHADOW_GRID = 96
_ROW = 256


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Light:
    """A map made ready: its irradiance, and itself at growing blurs."""

    irradiance: NDArray[np.float32]
    levels: tuple[NDArray[np.float32], ...]

    def diffuse(self, normals: Floats) -> Floats:
        """What a white surface that faces `normals` sends out, (..., 3)."""
        return _looked_up(self.irradiance, normals) / np.pi

    def mirrored(self, directions: Floats, roughness: Floats) -> Floats:
        """The map around `directions` (N, 3), as blurred as a lobe of `roughness` (N,)."""
        place = np.interp(roughness, _LEVELS, np.arange(len(_LEVELS)))
        total = np.zeros((*directions.shape[:-1], 3))
        for index, level in enumerate(self.levels):
            share = np.maximum(1 - np.abs(place - index), 0)
            used = np.flatnonzero(share)
            if len(used):
                total[used] += share[used, None] * _looked_up(level, directions[used])
        return total


def _looked_up(picture: NDArray[np.float32], directions: Floats) -> Floats:
    """The picture in directions (N, 3), which are laid out in rows for the sake of OpenCV."""
    count = len(directions)
    grid = np.zeros((-(-count // _ROW), _ROW, 3), np.float32)
    grid[..., 2] = -1
    grid.reshape(-1, 3)[:count] = directions
    return np.asarray(sample(picture, grid).reshape(-1, 3)[:count], np.float64)


class AnalyticRenderer:
    """Renders by formula; see the module."""

    def describe(self) -> Mapping[str, Any]:
        """Name and version."""
        return {"name": "analytic", "version": VERSION}

    def render(
        self, scene: Scene, views: tuple[View, ...], quality: Quality, seed: int
    ) -> tuple[ViewPasses, ...]:
        """The passes of each view; quality and seed change nothing."""
        light = _prepared(scene.light)
        return tuple(_passes(scene, light, view) for view in views)

    def reflectance(
        self, material: Material, light: EnvironmentMap, quality: Quality, seed: int, width_px: int
    ) -> NDArray[np.float32]:
        """The formula at every normal that faces the camera; a texture counts by its color."""
        normals, inside = sphere_normals(width_px)
        picture = np.zeros((width_px, width_px, 3), np.float32)
        facing = normals[inside]
        toward = np.broadcast_to(np.array([0.0, 0, 1]), facing.shape)
        colors = np.broadcast_to(np.asarray(material.base_color), facing.shape)
        figures = _figures((material,), np.zeros(len(facing), int))
        picture[inside] = _shade(facing, toward, colors, figures, _prepared(light))
        return picture


def sphere_normals(width_px: int) -> tuple[Floats, NDArray[np.bool_]]:
    """The normals of a sphere that fills a picture, (W, W, 3), and where it is, (W, W)."""
    across = (np.arange(width_px) + 0.5) / width_px * 2 - 1
    x, y = np.meshgrid(across, -across)
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    return np.where(inside[..., None], np.stack([x, y, z], axis=-1), 0.0), inside


def _prepared(light: EnvironmentMap) -> _Light:
    small = resize_radiance(light.radiance, min(_MAP_WIDTH_PX, light.width_px))
    # Roughness r is a GGX lobe of alpha = r^2, about exp(-theta_h^2 / alpha^2) over half
    # vectors; over mirrored directions twice as wide, which is kappa = 1 / (2 alpha^2).
    levels = [blur_radiance(small, kappa=max(0.5 / level**4, 0.6)) for level in _LEVELS]
    return _Light(irradiance=irradiance_map(light.radiance, 64), levels=tuple(levels))


def _passes(scene: Scene, light: _Light, view: View) -> ViewPasses:
    mesh, size = scene.mesh, (view.height_px, view.width_px)
    hits = look(mesh.vertices, mesh.faces, view, _OVERSAMPLING)
    there = hits.face >= 0
    part = mesh.part[hits.face]
    position = hits.blend(mesh.vertices[mesh.faces].astype(np.float64))
    toward = np.asarray(view.position) - position
    toward /= np.linalg.norm(toward, axis=-1, keepdims=True)
    normals = hits.blend(corner_normals(mesh).astype(np.float64))
    flat = face_normals(mesh.vertices.astype(np.float64), mesh.faces)[hits.face]
    # The back of an open surface is lit as its front would be.
    behind = np.einsum("hwi,hwi->hw", flat, toward) < 0
    normals = np.where(behind[..., None], -normals, normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)
    place = hits.blend(box_coordinates(mesh).astype(np.float64))
    albedo = np.zeros((*hits.face.shape, 3), np.float32)
    for index, material in enumerate(scene.materials):
        mine = there & (part == index)
        albedo[mine] = texture_at(material, place[mine])
    radiance = np.zeros_like(albedo)
    radiance[there] = _shade(
        normals[there], toward[there], albedo[there], _figures(scene.materials, part[there]), light
    )
    middle = (slice(_OVERSAMPLING // 2, None, _OVERSAMPLING),) * 2
    center = there[middle]
    _, _, depth = view.project(position[middle])
    turned = view.world_from_camera.inverse.apply(normals[middle])
    return ViewPasses(
        radiance=_mean(radiance),
        coverage=_mean(there.astype(np.float32)),
        part=np.where(center, part[middle] + 1, 0).astype(np.uint8),
        normal=np.where(center[..., None], turned, 0).astype(np.float32),
        depth=np.where(center, depth, NO_DEPTH).astype(np.float32),
        albedo=np.where(center[..., None], albedo[middle], 0).astype(np.float32),
        shadow=None if scene.floor_m is None else _shadow(scene, scene.floor_m, view, size),
    )


def _mean(values: NDArray[np.float32]) -> NDArray[np.float32]:
    height, width = (length // _OVERSAMPLING for length in values.shape[:2])
    blocks = values.reshape(height, _OVERSAMPLING, width, _OVERSAMPLING, *values.shape[2:])
    return blocks.mean(axis=(1, 3), dtype=np.float64).astype(np.float32)


def _figures(materials: tuple[Material, ...], index: NDArray[Any]) -> dict[str, Floats]:
    names = ("roughness", "metallic", "specular", "sheen", "clearcoat", "clearcoat_gloss")
    return {
        name: np.array([getattr(material, name) for material in materials])[index] for name in names
    }


def _shade(
    normals: Floats, toward: Floats, albedo: Floats, figures: dict[str, Floats], light: _Light
) -> NDArray[np.float32]:
    """Radiance toward the viewer, (N, 3), of surfaces of a principled material.

    What is mirrored is taken from what is diffuse, so that a white object in a uniform map has
    exactly the radiance of the map.
    """
    cosine = np.clip(np.einsum("ni,ni->n", normals, toward), 0, 1)[:, None]
    mirrored = 2 * np.einsum("ni,ni->n", normals, toward)[:, None] * normals - toward
    figure = {name: values[:, None] for name, values in figures.items()}
    grazing = (1 - cosine) ** 5
    dielectric = 0.08 * figure["specular"]
    straight = dielectric * (1 - figure["metallic"]) + albedo * figure["metallic"]
    # Rough surfaces have less of a bright rim, and one without reflection has none.
    rim = np.maximum(np.minimum(1 - figure["roughness"], 25 * straight), straight)
    fresnel = straight + (rim - straight) * grazing
    diffuse = light.diffuse(normals)
    cloth = 0.5 * figure["sheen"] * grazing * (1 - figure["metallic"])
    body = albedo * (1 - figure["metallic"]) * (1 - fresnel) * diffuse
    body = body * (1 - cloth) + cloth * diffuse
    body = body + fresnel * light.mirrored(mirrored, figures["roughness"])
    coat = 0.25 * figure["clearcoat"] * (0.04 + 0.96 * grazing)
    gloss = 0.5 - 0.4 * figures["clearcoat_gloss"]
    varnish = light.mirrored(mirrored, gloss) if np.any(coat > 1e-3) else 0.0
    return np.asarray(body * (1 - coat) + coat * varnish, np.float32)


def _shadow(scene: Scene, floor_m: float, view: View, size: tuple[int, int]) -> Floats:
    """What is left of the floor's light, (H, W, 3), by the shadows of the strongest parcels."""
    energies, vectors = light_parcels(scene.light.radiance, (8, 16))
    direction = vectors.sum(axis=1)
    direction /= np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), 1e-12)
    weight = energies * np.maximum(direction[:, 1:2], 0)
    rays = view.rays()
    down = np.minimum(rays[..., 1], -1e-9)
    reach = (floor_m - view.position[1]) / down
    met = (rays[..., 1] < 0) & (reach > 0)
    point = np.asarray(view.position) + rays * reach[..., None]
    total = weight.sum(axis=0)
    lost = np.zeros((*size, 3))
    for index in np.argsort(-weight.sum(axis=1), kind="stable")[:_SHADOWS]:
        if direction[index, 1] > 0.05:
            dark = _in_shadow(scene, floor_m, direction[index], point)
            lost += np.where((dark & met)[..., None], weight[index], 0)
    return np.clip(1 - lost / np.maximum(total, 1e-30), 0, 1).astype(np.float32)


def _in_shadow(scene: Scene, floor_m: float, direction: Floats, point: Floats) -> NDArray[np.bool_]:
    """Which points of the floor the object hides from light out of one direction."""
    vertices = scene.mesh.vertices.astype(np.float64)
    slope = direction[[0, 2]] / direction[1]
    cast = vertices[:, [0, 2]] - (vertices[:, 1:2] - floor_m) * slope
    low, high = cast.min(axis=0), cast.max(axis=0)
    scale = _SHADOW_GRID / np.maximum(high - low, 1e-9)
    hits: Hits = rasterize(
        (cast - low) * scale, np.ones(len(cast)), scene.mesh.faces, (_SHADOW_GRID, _SHADOW_GRID)
    )
    cell = np.floor((point[..., [0, 2]] - low) * scale)
    inside = ((cell >= 0) & (cell < _SHADOW_GRID)).all(axis=-1)
    column, row = (np.where(inside, cell[..., k], 0).astype(int) for k in (0, 1))
    return np.asarray(inside & (hits.face[row, column] >= 0))

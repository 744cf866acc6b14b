"""Light, and if need be material, that make a renderer show what was seen in both views.

Rays are traced through the known shape, with its shadows and what it reflects of itself; the error
of the pictures is traced back to the light along the same kind of rays. Light is changed in its
logarithm, so that it stays positive, by Adam (Kingma and Ba 2015). This is what may be had with
the shape known and no learning, at a hundred times the cost of a network.
"""

from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_decode_u8
from panokit.color.luminance import luminance
from panokit.dataset.objects.catalog import ObjectCatalog
from panokit.dataset.renderers.mitsuba_scene import Camera, LoadedScene
from panokit.dataset.scene import Material
from panokit.evaluate.lighting.sample import StereoSample
from panokit.evaluate.rendering.known import KnownGeometry, known_geometry, open_objects
from panokit.io.adapters.mitsuba import pad_columns
from panokit.io.adapters.nodes import rows_as_cells
from panokit.renderer import differentiable_mitsuba, gradient_of, use_one_thread, watch_gradient
from panokit.sphere.equirect import equirect_pixel
from panokit.stereo import Views

Picture = NDArray[np.float32]
# The map that is fitted: its columns, and its rows of nodes, the first and last on the poles.
_ACROSS, _DOWN = 64, 32
# As in the least squares: without knowing better, surfaces give back half of the light.
_ALBEDO, _ROUGHNESS = 0.5, 0.4
# What is at the limit of the picture may be any brighter.
_BURNT = 250 / 255
# Of Adam, in logs of light, and in color and roughness.
_STEP, _MATERIAL_STEP = 0.08, 0.02
# How much evenness, and the background that is seen, count beside the views.
_SMOOTH, _BEHIND = 0.02, 2.0
# Added to what relative errors are relative to: a twentieth of white.
_FLOOR = 0.05


class DifferentiableRendering:
    """Fits a 64x32 map to both views with Mitsuba 3; knows the shape, and perhaps the material.

    Args:
        material: "known" takes the true materials; "fitted" starts from gray and finds color and
            roughness too, with half of the light given back on the whole.
        meshes: The folder that the dataset's meshes are from, if it has any.
        width_px: At which the views are compared.
        rounds: Changes of the light.
        samples: Paths per pixel in each of them.

    Raises:
        MissingExtraError: If Mitsuba, or the libLLVM that it needs for gradients, is missing.
    """

    def __init__(
        self,
        material: Literal["known", "fitted"] = "known",
        meshes: Path | None = None,
        *,
        width_px: int = 64,
        rounds: int = 120,
        samples: int = 16,
    ) -> None:
        differentiable_mitsuba()
        use_one_thread()
        self.name = f"differentiable rendering ({material} material)"
        self.digest = f"1-{material}-{width_px}-{rounds}-{samples}"
        self._material, self._catalog = material, _catalog(meshes)
        self._width_px, self._rounds, self._samples = width_px, rounds, samples

    def predict(self, sample: StereoSample) -> Picture:
        """(64, 64, 3) linear radiance, anamorphic, in the left camera's frame, 1.0 white.

        Raises:
            ItemError: If the sample's object cannot be rebuilt.
        """
        known = known_geometry(sample.meta, self._catalog, self._width_px)
        materials = known.materials
        if self._material == "fitted":
            gray = Material(base_color=(_ALBEDO,) * 3, roughness=_ROUGHNESS)
            materials = (gray,) * len(materials)
        fit = _Fit(sample.views, known, materials, self._width_px)
        for number in range(self._rounds):
            # Toward the end smaller steps, so that what the noise of paths did evens out.
            step = 0.5 * (1 + np.cos(np.pi * number / self._rounds)) + 0.05
            fit.improve(step, self._samples, 2 * number, with_material=self._material == "fitted")
        return fit.light()


class _Fit:
    """One sample: its scene, what was seen of it, and the light and surfaces found so far."""

    def __init__(
        self, views: Views, known: KnownGeometry, materials: tuple[Material, ...], width_px: int
    ) -> None:
        self._loaded = _scene()
        self._loaded.set_mesh(known.mesh)
        self._loaded.set_materials(materials)
        self._loaded.update()
        self._mitsuba = differentiable_mitsuba()
        self._parameters = self._mitsuba.traverse(self._loaded.scene)
        self._cameras = [_camera(view.name, width_px) for view in known.views]
        for camera, view in zip(self._cameras, known.views, strict=True):
            camera.aim(view)
        self._seen = [_target(p, width_px) for p in (views.left_object, views.right_object)]
        start = _Behind(views)
        self._log_light = _Adam(np.log(start.level), _STEP)
        self._behind = start
        self._surfaces = [
            _Adam(np.array([*material.base_color, material.roughness]), _MATERIAL_STEP)
            for material in materials
        ]

    def improve(self, step: float, samples: int, seed: int, *, with_material: bool) -> None:
        """One change of light, and of material if that is to be found too."""
        watched = self._set(with_material)
        for number, (camera, seen) in enumerate(zip(self._cameras, self._seen, strict=True)):
            shown = self._render(camera, samples, 4 * seed + number)
            picture, alpha = shown[..., :3], shown[..., 3:]
            error = _error_gradient(picture, alpha, seen)
            error = np.concatenate([error, np.zeros_like(alpha)], axis=-1)
            # Other paths than those of the picture: with the same ones noise would be fitted.
            _integrator().render_backward(
                self._loaded.scene, self._parameters, self._mitsuba.TensorXf(error),
                sensor=camera.sensor, seed=4 * seed + number + 2, spp=samples,
            )  # fmt: skip
        light = np.exp(self._log_light.value)
        folded = _folded(gradient_of(watched["light.data"]), light.shape)
        gradient = folded * light + self._behind.gradient(light) + _unevenness_gradient(light)
        self._log_light.move(gradient, step)
        if with_material:
            for index, surface in enumerate(self._surfaces):
                color = gradient_of(watched[_color_key(index)]).reshape(3)
                rough = gradient_of(watched[_rough_key(index)]).reshape(1)
                surface.move(np.concatenate([color, rough]), step)
                surface.value = _half_gray(surface.value)

    def light(self) -> Picture:
        """The map as it is now, (64, 64, 3)."""
        cells = rows_as_cells(np.exp(self._log_light.value))
        return np.ascontiguousarray(np.repeat(cells, 2, axis=0), np.float32)

    def _set(self, with_material: bool) -> dict[str, Any]:
        light = pad_columns(np.exp(self._log_light.value).astype(np.float32))
        values = {"light.data": self._mitsuba.TensorXf(light)}
        if with_material:
            for index, surface in enumerate(self._surfaces):
                color = [float(v) for v in surface.value[:3]]
                values[_color_key(index)] = self._mitsuba.Color3f(*color)
                values[_rough_key(index)] = self._mitsuba.Float(float(surface.value[3]))
        for key, value in values.items():
            watch_gradient(value)
            self._parameters[key] = value
        self._parameters.update()
        return values

    def _render(self, camera: Camera, samples: int, seed: int) -> Picture:
        picture = self._mitsuba.render(
            self._loaded.scene, sensor=camera.sensor, integrator=_integrator(), spp=samples,
            seed=seed,
        )  # fmt: skip
        return np.array(picture, np.float32)


class _Adam:
    """A value that is made better by gradients (Kingma and Ba 2015, algorithm 1).

    Steps do not depend on the size of the gradients, only on how steady they are.
    """

    def __init__(self, value: NDArray[np.floating[Any]], step: float) -> None:
        self.value = np.asarray(value, np.float64)
        self._step, self._count = step, 0
        self._mean, self._square = np.zeros_like(self.value), np.zeros_like(self.value)

    def move(self, gradient: NDArray[np.floating[Any]], factor: float) -> None:
        self._count += 1
        self._mean = 0.9 * self._mean + 0.1 * gradient
        self._square = 0.99 * self._square + 0.01 * gradient**2
        mean = self._mean / (1 - 0.9**self._count)
        square = self._square / (1 - 0.99**self._count)
        self.value = self.value - factor * self._step * mean / (np.sqrt(square) + 1e-8)


class _Behind:
    """What the background tells of the texels that are in the picture, and where to start."""

    def __init__(self, views: Views) -> None:
        height, width = views.mask.shape
        focal = views.focal_px
        at = (np.arange(width) + 0.5 - width / 2) / focal
        up = (height / 2 - np.arange(height) - 0.5) / focal
        x, y = np.meshgrid(at, up)
        rays = np.stack([x, y, -np.ones_like(x)], axis=-1)
        column, _ = equirect_pixel(rays, _ACROSS, _DOWN)
        # Rows of nodes: the first on the zenith, the last on the nadir.
        polar = np.arccos(np.clip(rays[..., 1] / np.linalg.norm(rays, axis=-1), -1, 1))
        row = np.rint(polar / np.pi * (_DOWN - 1)).astype(int)
        place = row * _ACROSS + np.rint(column).astype(int) % _ACROSS
        seen = srgb_decode_u8(views.background).reshape(-1, 3)
        known = bool(views.background.any())
        self._count = np.bincount(place.ravel(), minlength=_ACROSS * _DOWN) * float(known)
        sums = [np.bincount(place.ravel(), c, minlength=_ACROSS * _DOWN) for c in seen.T]
        mean = np.stack(sums, axis=1) / np.maximum(self._count, 1)[:, None]
        shape = (_DOWN, _ACROSS, 3)
        self._mean = mean.reshape(shape)
        self._weight = (self._count / max(self._count.sum(), 1)).reshape(_DOWN, _ACROSS, 1)
        object_mean = srgb_decode_u8(views.left_object)[views.mask]
        ambient = object_mean.mean(axis=0) / _ALBEDO if len(object_mean) else np.full(3, 0.5)
        start = np.where(self._weight > 0, self._mean, np.maximum(ambient, 1e-3))
        self.level = np.maximum(start, 1e-3)

    def gradient(self, light: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of half the relative squared error, by the log of light; (32, 64, 3).

        Burnt-out texels may be any brighter.
        """
        away = light - self._mean
        away = np.where((self._mean > _BURNT) & (away > 0), 0, away)
        return np.asarray(_BEHIND * self._weight * away / (self._mean + _FLOOR) ** 2 * light)


def _target(picture: NDArray[np.uint8], width_px: int) -> Picture:
    """What is to be shown, linear, at the size of the comparison."""
    linear = srgb_decode_u8(picture).astype(np.float32)
    return np.asarray(
        cv2.resize(linear, (width_px, width_px), interpolation=cv2.INTER_AREA), np.float32
    )


def _error_gradient(picture: Picture, alpha: Picture, seen: Picture) -> Picture:
    """Of half the mean relative squared error over the object's pixels, by the picture."""
    on = (alpha > 0.5) & (seen.max(axis=-1, keepdims=True) > 0)
    away = picture - seen
    away = np.where((seen > _BURNT) & (away > 0), 0, away)
    # One pixel of noise must not push as much as the rest together.
    relative = np.clip(away / (seen + _FLOOR), -4, 4) / (seen + _FLOOR)
    return np.asarray(np.where(on, relative, 0) / max(float(on.sum()), 1.0), np.float32)


def _folded(gradient: NDArray[np.float32], shape: tuple[int, ...]) -> NDArray[np.float64]:
    """The gradient by the columns that are one's own.

    Mitsuba keeps a copy of the last column at the left and of the first at the right.
    """
    own = gradient.reshape(shape[0], shape[1] + 2, 3).astype(np.float64)
    folded = own[:, 1:-1].copy()
    folded[:, -1] += own[:, 0]
    folded[:, 0] += own[:, -1]
    return folded


def _unevenness_gradient(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of half the mean squared difference between logs of neighbors, by the logs."""
    logs = np.log(light)
    found = 4 * logs - np.roll(logs, 1, axis=1) - np.roll(logs, -1, axis=1)
    found[1:] -= logs[:-1]
    found[:-1] -= logs[1:]
    found[0] -= logs[0]
    found[-1] -= logs[-1]
    return np.asarray(_SMOOTH * found / logs.size)


def _half_gray(surface: NDArray[np.float64]) -> NDArray[np.float64]:
    """A surface that gives back half of the light on the whole, in any color."""
    color = np.clip(surface[:3], 0.02, 1)
    color = np.clip(color * _ALBEDO / float(luminance(color)), 0.02, 0.98)
    return np.array([*color, np.clip(surface[3], 0.05, 1)])


def _color_key(index: int) -> str:
    return f"part{index}.bsdf.brdf_0.base_color.value"


def _rough_key(index: int) -> str:
    return f"part{index}.bsdf.brdf_0.roughness.value"


@lru_cache(maxsize=4)
def _catalog(meshes: Path | None) -> ObjectCatalog:
    return open_objects(meshes)


@lru_cache(maxsize=1)
def _scene() -> LoadedScene:
    """A scene of this module's own: its map has another size than those of datasets."""
    return LoadedScene()


@lru_cache(maxsize=4)
def _camera(name: str, width_px: int) -> Camera:
    return Camera(width_px, width_px, kind="perspective", sampler={"type": "independent"})


@lru_cache(maxsize=1)
def _integrator() -> Any:
    return differentiable_mitsuba().load_dict(
        {"type": "prb", "max_depth": 3, "hide_emitters": True}
    )

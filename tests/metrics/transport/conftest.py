"""The scenes as Mitsuba renders them, and figures of agreement."""

from dataclasses import dataclass

import numpy as np
import pytest

from panokit.metrics.balls import ball_error
from panokit.metrics.transport import figure as bear
from panokit.metrics.transport import relight
from panokit.renderer import environment_emitter, load_mitsuba

BALL_PX = 32
MIRROR_PX = 64
QUIET = 0.01
PLANE_PX = 64


def size_of(scene):
    return {"plane": PLANE_PX, "mirror": MIRROR_PX}.get(scene, BALL_PX)


def gray(value):
    return {"type": "rgb", "value": value}


def rough(alpha):
    # Material "none" is a conductor that reflects everything: no Fresnel term.
    return {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": alpha}


def principled(metallic, roughness):
    return {
        "type": "principled",
        "base_color": gray(0.8),
        "metallic": metallic,
        "roughness": roughness,
        "specular": 0.5,
    }


MATERIALS = {
    "diffuse": {"type": "diffuse", "reflectance": gray(1.0)},
    "glossy-0.1": rough(0.1),
    "glossy-0.3": rough(0.3),
    "glossy-0.6": rough(0.6),
    "mirror": {"type": "conductor", "material": "none"},
    "matte-silver": principled(1.0, 0.3271),
    "principled-diffuse": principled(0.0, 0.364),
}


def finer(radiance, parts):
    """The map between its texels, cut finer: Mitsuba's rows stand elsewhere than ours."""
    height, width = radiance.shape[:2]
    down = np.clip((np.arange(height * parts) + 0.5) / parts - 0.5, 0, height - 1)
    above = np.minimum(down.astype(int), height - 2)
    share = (down - above).astype(np.float32)[:, None, None]
    rows = radiance[above] * (1 - share) + radiance[above + 1] * share
    right = (np.arange(width * parts) + 0.5) / parts - 0.5
    left = np.floor(right).astype(int)
    share = (right - left).astype(np.float32)[None, :, None]
    return rows[:, left % width] * (1 - share) + rows[:, (left + 1) % width] * share


def camera(mitsuba, kind, place, target, size_px, **more):
    return {
        "type": kind,
        "to_world": mitsuba.ScalarTransform4f().look_at(place, target, [0, 1, 0]),
        "film": {
            "type": "hdrfilm",
            "width": size_px,
            "height": size_px,
            "rfilter": {"type": "box"},
            "pixel_format": "rgba",
            "component_format": "float32",
        },
        "sampler": {"type": "multijitter"},
        **more,
    }


def shapes(mitsuba, scene):
    if scene != "plane":
        return {
            "ball": {"type": "sphere", "bsdf": MATERIALS[scene]},
            "camera": camera(mitsuba, "orthographic", [0, 0, 4], [0, 0, 0], size_of(scene)),
        }
    flat = mitsuba.ScalarTransform4f().rotate([1, 0, 0], -90).scale([1000, 1000, 1])
    parts = {
        "floor": {
            "type": "rectangle",
            "to_world": flat,
            "bsdf": {"type": "diffuse", "reflectance": gray(bear.FLOOR_ALBEDO)},
        },
        "camera": camera(
            mitsuba,
            "perspective",
            bear.CAMERA_PLACE.tolist(),
            bear.CAMERA_TARGET.tolist(),
            size_of(scene),
            fov=bear.FIELD_OF_VIEW_DEG,
            near_clip=0.1,
        ),
    }
    for index, (*center, radius) in enumerate(bear.SPHERES.tolist()):
        parts[f"sphere{index}"] = {
            "type": "sphere",
            "center": center,
            "radius": radius,
            "bsdf": {"type": "diffuse", "reflectance": gray(bear.BEAR_ALBEDO)},
        }
    return parts


@dataclass(frozen=True)
class Agreement:
    """Relative RMS difference, what of it is the renderer's noise, and that of the means."""

    error: float
    noise: float
    mean: float

    @property
    def without_noise(self):
        """Unbiased: of two halves a and b of the samples, the mean of (ours - a) (ours - b)."""
        return np.sqrt(max(self.error**2 - self.noise**2, 0))


@pytest.fixture(scope="session")
def agreement():
    """A function of a map, a scene and samples per pixel, which goes on while it is noisy."""
    mitsuba = load_mitsuba()

    def compare(radiance, scene, samples, most_turns=3):
        light = environment_emitter(finer(radiance, 4 if scene == "mirror" else 2))
        # Light straight from the map to the surface and to the camera, as in the tables.
        path = {"type": "path", "max_depth": 2, "hide_emitters": True}
        loaded = mitsuba.load_dict(
            {"type": "scene", "light": light, "path": path, **shapes(mitsuba, scene)}
        )
        halves = [0, 0]
        for turn in range(1, most_turns + 1):
            for side in (0, 1):
                rendered = np.array(mitsuba.render(loaded, spp=samples, seed=2 * turn + side))
                rendered[..., :3] /= np.maximum(rendered[..., 3:], 1e-6)
                halves[side] = halves[side] + (rendered - halves[side]) / turn
            if ball_error(*halves) / 2 < QUIET:
                break
        truth = (halves[0] + halves[1]) / 2
        ours = relight(radiance, scene, size_of(scene))
        alpha = truth[..., 3:]
        return Agreement(
            error=ball_error(ours, truth),
            noise=ball_error(*halves) / 2,
            mean=float((ours * alpha)[..., :3].sum() / (truth * alpha)[..., :3].sum()) - 1,
        )

    return compare

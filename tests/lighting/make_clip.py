"""Makes the clip that comes with panokit, and the truth of it for the judge.

    python -m tests.lighting.make_clip [FRAMES] [SAMPLES]

A place of the synthetic city that no dataset has seen, an object with a number beyond those of
any dataset, and a camera that moves sideways past it, level and without turning. The place is
given a depth (a ground and a far wall), so that the background moves as it should; the light on
the object is that of the map, infinitely far.
"""

import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from panokit.color import srgb_encode_u8
from panokit.dataset.make import aligned_light
from panokit.dataset.objects.kinds import make_object
from panokit.dataset.photograph import metered_exposure
from panokit.dataset.renderers.mitsuba import MitsubaRenderer
from panokit.dataset.scene import Material, Quality, Scene, View
from panokit.envmap import EnvironmentMap
from panokit.frames import Frame, Rotation
from panokit.io import write_exr
from panokit.lighting.clip import CLIP_FOV_DEG, clip_path
from panokit.sphere import resize_radiance, sample
from panokit.synthetic.generate import render_truth
from panokit.synthetic.settings import CitySettings
from panokit.synthetic.shots import plan_shots

SEED = 22
SHOT = 2
SIZE = (640, 360)
FPS = 25
FRAMES, SAMPLES = 60, 24
# Of this kind datasets take numbers up to 249.
OBJECT = ("teapot", 1018)
MATERIAL = Material(base_color=(0.05, 0.27, 0.36), roughness=0.35, metallic=1e-4, specular=0.5,
                    sheen=1e-4, flatness=1e-4, clearcoat=1e-4, clearcoat_gloss=0.9)  # fmt: skip
HEADING_DEG = 20.0
DISTANCE_M, HALF_WAY_M = 2.6, 0.55
OBJECT_BELOW_M = 0.12
CAMERA_HEIGHT_M, WALL_M = 2.4, 16.0
NOISE = 0.004
TRUTH = Path(__file__).parent / "clip_truth.exr"


def place() -> np.ndarray:
    settings = CitySettings(
        count=SHOT + 1, seed=SEED, weather="clear", truth_width_px=1024, truth_samples=6
    )
    return render_truth(plan_shots(settings)[SHOT], settings)


def behind(radiance: np.ndarray, view: View) -> np.ndarray:
    """What is seen of the place from beside the point where its map was taken."""
    rays, at = view.rays(), np.array(view.position)
    along = (rays * at).sum(axis=-1)
    far = -along + np.sqrt(along**2 - (at**2).sum() + WALL_M**2)
    down = np.where(rays[..., 1] < -1e-6, (-CAMERA_HEIGHT_M - at[1]) / rays[..., 1], np.inf)
    hit = at + rays * np.minimum(far, down)[..., None]
    hit /= np.linalg.norm(hit, axis=-1, keepdims=True)
    return sample(radiance, hit)


def views(count: int) -> list[View]:
    turn = Rotation.from_heading_pitch_roll(float(np.deg2rad(HEADING_DEG)))
    side = turn.matrix[:, 0]
    steps = np.linspace(-HALF_WAY_M, HALF_WAY_M, count)
    more = {"fov_deg": CLIP_FOV_DEG, "width_px": SIZE[0], "height_px": SIZE[1]}
    places = [tuple(float(v) for v in side * step) for step in steps]
    return [View(name="left", position=at, world_from_camera=turn, **more) for at in places]


def scene_in(radiance: np.ndarray, turn: Rotation) -> Scene:
    mesh = make_object(*OBJECT)
    center = -turn.matrix[:, 2] * DISTANCE_M + np.array([0, -OBJECT_BELOW_M, 0])
    placed = replace(
        mesh, vertices=mesh.vertices + center.astype(np.float32), part=np.zeros_like(mesh.part)
    )
    light = EnvironmentMap(radiance=resize_radiance(radiance, 512), frame=Frame.WORLD)
    return Scene(mesh=placed, materials=(MATERIAL,), light=light)


def main(count: int = FRAMES, samples: int = SAMPLES, radiance: np.ndarray | None = None) -> None:
    radiance = place() if radiance is None else radiance
    path, all_views = clip_path(), views(count)
    scene = scene_in(radiance, all_views[0].world_from_camera)
    renderer, rng = MitsubaRenderer(), np.random.default_rng(SEED)
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"mp4v"), FPS, SIZE)
    exposure = 0.0
    for number, view in enumerate(all_views):
        seen = renderer.render(scene, (view,), Quality(samples=samples), SEED + number)[0]
        picture = seen.radiance + (1 - seen.coverage)[..., None] * behind(radiance, view)
        # Metered once: the exposure is fixed.
        exposure = exposure or metered_exposure(picture, seen.coverage)
        encoded = srgb_encode_u8(picture * exposure) + rng.normal(0, 255 * NOISE, picture.shape)
        frame = np.clip(np.rint(encoded), 0, 255).astype(np.uint8)
        writer.write(np.ascontiguousarray(frame[..., ::-1]))
    writer.release()
    truth = aligned_light(
        EnvironmentMap(radiance=radiance, frame=Frame.WORLD), all_views[0].world_from_camera
    )
    write_exr(
        TRUTH,
        resize_radiance(truth.radiance * np.float32(exposure), 64, 64),
        {"panokit:projection": "equirectangular-anamorphic"},
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))

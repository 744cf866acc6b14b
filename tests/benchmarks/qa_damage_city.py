"""Places of the synthetic city with a known sun, to flip and to turn; rendered once and kept."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from panokit.envmap import Anchor, EnvironmentMap
from panokit.errors import MissingExtraError
from panokit.frames import Frame, Rotation, angle_between
from panokit.io import read_environment_map, write_environment_map
from panokit.sun import sun_direction
from panokit.synthetic.settings import CitySettings
from panokit.synthetic.shots import Shot, plan_shots

CITIES = ((6, "clear"), (7, "cloudy"))
COUNT = 12
WIDTH_PX, SAMPLES = 512, 4
# A change that moves the sun by no more than a check allows cannot be seen.
LEAST_MOVE_DEG = 6.0


def places(folder: Path) -> Sequence[EnvironmentMap]:
    """24 maps, 512x256, half of clear and half of cloudy days; empty without Mitsuba."""
    maps = []
    for seed, weather in CITIES:
        for shot in plan_shots(CitySettings(count=COUNT, seed=seed, weather=weather)):
            path = folder / f"{shot.capture.id}.exr"
            if not path.exists():
                try:
                    write_environment_map(_rendered(shot), path)
                except MissingExtraError:
                    return []
            maps.append(read_environment_map(path))
    return maps


def flipped(envmap: EnvironmentMap) -> EnvironmentMap:
    return envmap.with_changes(radiance=np.ascontiguousarray(envmap.radiance[:, ::-1]))


def turned(envmap: EnvironmentMap) -> EnvironmentMap:
    half = envmap.width_px // 2
    return envmap.with_changes(radiance=np.roll(envmap.radiance, half, axis=1))


def sun_moves(envmap: EnvironmentMap, x: float, z: float) -> bool:
    """Whether a change of the sun's signs moves it by more than the check allows."""
    capture = envmap.capture
    if capture is None or capture.time is None:
        return False
    sun = sun_direction(capture.latitude_deg or 0.0, capture.longitude_deg or 0.0, capture.time)
    return float(np.degrees(angle_between(sun, sun * [x, 1, z]))) > LEAST_MOVE_DEG


def _rendered(shot: Shot) -> EnvironmentMap:
    """The place with north at the center, noisy: only its sun is looked at."""
    from panokit.synthetic.building_site import build_place, world_placement
    from panokit.synthetic.generate import sky_of
    from panokit.synthetic.photograph import metered_exposure
    from panokit.synthetic.places import plan_place
    from panokit.synthetic.render import View, render_radiance
    from panokit.synthetic.scene import load_scene

    plan, sky = plan_place(shot.kind, shot.place_seed), sky_of(shot)
    with tempfile.TemporaryDirectory() as folder:
        scene = load_scene(build_place(plan, night=False, rig=False), sky, Path(folder), {})
    x, y, z = world_placement(plan).apply(np.array(plan.camera_m)).tolist()
    view = View(
        position_m=(x, y, z), world_from_camera=Rotation.identity(), width_px=WIDTH_PX,
        samples=SAMPLES, denoise=False,
    )  # fmt: skip
    radiance = render_radiance(scene, sky, view, shot.seed)
    scale = metered_exposure(radiance, night=False, stops=shot.stops).scale
    return EnvironmentMap(
        radiance=(radiance * np.float32(scale)).astype(np.float32),
        frame=Frame.WORLD,
        anchor=Anchor.LDR_WHITE,
        capture=shot.capture,
    )

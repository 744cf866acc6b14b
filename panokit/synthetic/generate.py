"""Panoramas of the synthetic city with their true radiance, on disk.

    OUT/panoramas/NAME.jpg + NAME.json    what a street camera saw, its rig at its foot
    OUT/truth/NAME.exr + NAME.json        the radiance itself: level, north at the center

The truth has no rig, and its unit is the level at which the picture clips.
"""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import Anchor, EnvironmentMap
from panokit.errors import UsageError
from panokit.frames import Frame, Rotation
from panokit.io import write_environment_map, write_panorama
from panokit.io.pictures import record_path
from panokit.panorama import Panorama
from panokit.provenance import Provenance, Step
from panokit.sphere import energy, resize_radiance
from panokit.sun import sun_direction
from panokit.synthetic.building_site import build_place, world_placement
from panokit.synthetic.city import PlacePlan
from panokit.synthetic.materials import Texture
from panokit.synthetic.photograph import metered_exposure, photograph
from panokit.synthetic.places import plan_place
from panokit.synthetic.render import View, render_radiance
from panokit.synthetic.scene import clear_sky, load_scene
from panokit.synthetic.settings import VERSION, CitySettings
from panokit.synthetic.shots import Shot, plan_shots
from panokit.synthetic.sky import Sky, night_sky, overcast_sky, with_clouds

PANORAMAS, TRUTH = "panoramas", "truth"
_TURBIDITY = 3.0
# Rendered at twice its width and averaged down, which smooths edges beyond a pixel's rays.
_TRUTH_OVERSIZE = 2


def render_city(
    settings: CitySettings, out: Path, on_done: Callable[[str, Path], None] | None = None
) -> list[Path]:
    """Render panoramas of the synthetic city; those that are there already are kept.

    Args:
        settings: How many, and how.
        out: The folder for `panoramas/` and `truth/`.
        on_done: Called with the name and the file of each panorama that was made.

    Returns:
        The panoramas' files, also those that were kept.

    Raises:
        MissingExtraError: If Mitsuba is not installed.
        StorageError: If the folder cannot be written.
    """
    files = []
    for shot in plan_shots(settings):
        path = Path(out) / PANORAMAS / f"{shot.capture.id}.jpg"
        files.append(path)
        if not record_path(path).exists():
            panorama, truth = render_shot(shot, settings)
            write_environment_map(truth, Path(out) / TRUTH / f"{shot.capture.id}.exr")
            # Its record is written last of all, and says that the pair is complete.
            write_panorama(panorama, path, quality=settings.jpeg_quality)
            if on_done is not None:
                on_done(shot.capture.id, path)
    return files


def render_shot(shot: Shot, settings: CitySettings) -> tuple[Panorama, EnvironmentMap]:
    """One panorama, in the camera's frame, and its truth, in the world's."""
    plan = plan_place(shot.kind, shot.place_seed)
    sky = sky_of(shot)
    painted: dict[Texture, Any] = {}
    truth = _render(shot, settings, plan, sky, painted, rig=False)
    picture = _render(shot, settings, plan, sky, painted, rig=True)
    exposure = metered_exposure(truth, night=shot.weather == "night", stops=shot.stops)
    step = Step(
        stage="synthetic",
        version=VERSION,
        settings_digest=settings.digest,
        values={
            "place_seed": shot.place_seed,
            "weather": shot.weather,
            "exposure": exposure.scale,
            "energy": (energy(truth) * exposure.scale).tolist(),
        },
    )
    provenance = Provenance((step,))
    panorama = Panorama(
        pixels=photograph(picture, exposure, shot.seed),
        capture=shot.capture,
        frame=Frame.CAMERA,
        provenance=provenance,
    )
    radiance = resize_radiance(truth * np.float32(exposure.scale), settings.truth_width_px)
    return panorama, EnvironmentMap(
        radiance=radiance,
        frame=Frame.WORLD,
        anchor=Anchor.LDR_WHITE,
        capture=shot.capture,
        provenance=provenance,
    )


def render_truth(shot: Shot, settings: CitySettings) -> NDArray[np.float32]:
    """The radiance of a place alone, (W, 2 W, 3) for `truth_width_px` W, in the world's frame."""
    return _render(
        shot, settings, plan_place(shot.kind, shot.place_seed), sky_of(shot), {}, rig=False
    )


def sky_of(shot: Shot) -> Sky:
    """The sky over a shot's place at its time."""
    if shot.weather == "night":
        return night_sky(shot.seed)
    if shot.weather == "overcast":
        return overcast_sky(shot.seed)
    capture = shot.capture
    if capture.latitude_deg is None or capture.longitude_deg is None or capture.time is None:
        raise UsageError(f"Shot {capture.id!r} needs a position and a time; use plan_shots.")
    sun = sun_direction(capture.latitude_deg, capture.longitude_deg, capture.time)
    clear = clear_sky(sun, _TURBIDITY)
    return clear if shot.weather == "clear" else with_clouds(clear, shot.seed)


def _render(
    shot: Shot,
    settings: CitySettings,
    plan: PlacePlan,
    sky: Sky,
    painted: dict[Texture, Any],
    *,
    rig: bool,
) -> NDArray[np.float32]:
    meshes = build_place(plan, night=shot.weather == "night", rig=rig)
    with tempfile.TemporaryDirectory(prefix="panokit-") as folder:
        scene = load_scene(meshes, sky, Path(folder), painted)
    position = world_placement(plan).apply(np.array(plan.camera_m))
    if rig:
        pose = shot.capture.world_from_camera or Rotation.identity()
        width_px, samples = settings.width_px, settings.samples
    else:
        pose = Rotation.identity()
        width_px, samples = _TRUTH_OVERSIZE * settings.truth_width_px, settings.truth_samples
    view = View(
        position_m=(float(position[0]), float(position[1]), float(position[2])),
        world_from_camera=pose,
        width_px=width_px,
        samples=samples,
        denoise=settings.denoise,
    )
    return render_radiance(scene, sky, view, shot.seed)

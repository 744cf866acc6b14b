"""Maps whose light is known because it was computed: rendered streets and analytic skies.

They are made once and kept as EXR files in the work folder. The sun of each is a disk of its
true size and radiance, so its energy is right at any resolution.
"""

import hashlib
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.envmap import EnvironmentMap
from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.io import write_environment_map
from panokit.io.pictures import record_path
from panokit.sphere import equirect_directions, irradiance, resize_radiance
from panokit.synthetic.building_site import build_place, world_placement
from panokit.synthetic.generate import sky_of
from panokit.synthetic.places import plan_place
from panokit.synthetic.render import View, render_radiance, sun_picture
from panokit.synthetic.scene import clear_sky, load_scene
from panokit.synthetic.settings import CitySettings
from panokit.synthetic.shots import Shot, plan_shots
from panokit.synthetic.sky import Sky, Weather, with_clouds
from panokit.train.probes import TrainingProbe
from panokit.train.recipe import SyntheticRecipe

# What the manifest of the probes would call each weather.
CATEGORY: dict[Weather, str] = {
    "clear": "outdoor_sunny",
    "cloudy": "outdoor_sunny",
    "overcast": "outdoor_overcast",
    "night": "outdoor_night",
}
OUTDOORS = ("outdoor_sunny", "outdoor_overcast", "outdoor_sunrise_sunset")
SKY_WIDTH_PX = 1024
LOWEST_SUN_DEG, HIGHEST_SUN_DEG = 3.0, 75.0
TURBIDITY = (2.0, 8.0)
# Of plain ground; distant fields, sand and asphalt lie in between.
ALBEDO = (0.08, 0.35)
# A probe's ground fades into the sky over this much of the horizon.
_HORIZON_DEG = 2.0


def synthetic_sources(
    recipe: SyntheticRecipe, probes: Sequence[TrainingProbe], work: Path
) -> list[tuple[TrainingProbe, int | None]]:
    """The computed maps of a recipe, made where they are missing.

    Args:
        recipe: How many of which.
        probes: Whose ground `grounded` skies stand on.
        work: Maps are kept in work/synthetic-<digest>.

    Returns:
        The maps, and the index of the probe whose ground each shows, None where none.

    Raises:
        MissingExtraError: If Mitsuba is not installed.
    """
    # How many, how often and how many pictures of each does not change what map i is.
    look = SyntheticRecipe(width_px=recipe.width_px, samples=recipe.samples, seed=recipe.seed)
    folder = work / f"synthetic-{look.digest[:12]}"
    outdoors = [i for i, probe in enumerate(probes) if probe.category in OUTDOORS]
    found: list[tuple[TrainingProbe, int | None]] = []
    shots = plan_shots(CitySettings(count=max(recipe.places, 1), seed=recipe.seed))
    for index, shot in enumerate(shots[: recipe.places]):
        path = folder / f"place-{index:04d}.exr"
        if not record_path(path).exists():
            _keep(render_place(shot, recipe), path)
        found.append((_listed(path, CATEGORY[shot.weather]), None))
    for index in range(recipe.skies):
        path = folder / f"sky-{index:04d}.exr"
        if not record_path(path).exists():
            _keep(sky_map(recipe.seed, index), path)
        found.append((_listed(path, "outdoor_sunny"), None))
    for index in range(recipe.grounded if outdoors else 0):
        random = np.random.default_rng([recipe.seed, index, 3])
        place = int(random.choice(outdoors))
        path = folder / f"grounded-{index:04d}-{probes[place].name}.exr"
        if not record_path(path).exists():
            _keep(grounded_map(recipe.seed, index, probes[place].radiance()), path)
        found.append((_listed(path, "outdoor_sunny"), place))
    return found


def render_place(shot: Shot, recipe: SyntheticRecipe) -> NDArray[np.float32]:
    """The light at a place of the synthetic city, (H, W, 3) float32, world frame."""
    plan = plan_place(shot.kind, shot.place_seed)
    sky = sky_of(shot)
    meshes = build_place(plan, night=shot.weather == "night", rig=False)
    with tempfile.TemporaryDirectory(prefix="panokit-") as folder:
        scene = load_scene(meshes, sky, Path(folder))
    x, y, z = world_placement(plan).apply(np.array(plan.camera_m)).tolist()
    view = View(
        position_m=(x, y, z),
        world_from_camera=Rotation.identity(),
        width_px=recipe.width_px,
        samples=recipe.samples,
    )
    return render_radiance(scene, sky, view, shot.seed)


def sky_map(seed: int, index: int) -> NDArray[np.float32]:
    """A clear or cloudy sky with its sun over plain ground, (512, 1024, 3) float32.

    The ground is lit by what stands above it: albedo x irradiance / pi.
    """
    random = np.random.default_rng([seed, index, 2])
    above = _sky_with_sun(random, index)
    received = irradiance(above, np.array([[0.0, 1.0, 0.0]]))[0]
    tint = np.exp(random.normal(0, 0.1, 3))
    albedo = np.exp(random.uniform(*np.log(ALBEDO))) * tint / luminance(tint)
    ground = (albedo * received / np.pi).astype(np.float32)
    return _joined(above, np.broadcast_to(ground, above.shape))


def grounded_map(seed: int, index: int, probe: NDArray[np.float32]) -> NDArray[np.float32]:
    """Such a sky over the ground of a probe, (512, 1024, 3) float32.

    The ground is scaled so that its mean is as bright under this sky as a surface of an
    albedo drawn at random. Its shadows remain those of its own sun.
    """
    random = np.random.default_rng([seed, index, 3])
    random.random()
    above = _sky_with_sun(random, index)
    ground = resize_radiance(probe, SKY_WIDTH_PX)
    below = ground[SKY_WIDTH_PX // 4 :]
    received = float(luminance(irradiance(above, np.array([[0.0, 1.0, 0.0]]))[0]))
    wanted = float(np.exp(random.uniform(*np.log(ALBEDO)))) * received / np.pi
    scale = wanted / max(float(np.median(luminance(below))), 1e-6)
    return _joined(above, ground * np.float32(scale))


def _sky_with_sun(random: np.random.Generator, index: int) -> NDArray[np.float32]:
    """The sky of a random time and haze, every second one with clouds; black below."""
    azimuth = random.uniform(-np.pi, np.pi)
    low, high = np.sin(np.radians([LOWEST_SUN_DEG, HIGHEST_SUN_DEG]))
    elevation = np.arcsin(random.uniform(low, high))
    sun = direction_from_azimuth_elevation(azimuth, elevation)
    sky: Sky = clear_sky(np.asarray(sun, np.float64), float(random.uniform(*TURBIDITY)))
    if index % 2:
        sky = with_clouds(sky, int(random.integers(1 << 31)), float(random.uniform(0.1, 0.7)))
    radiance = resize_radiance(np.asarray(sky.radiance, np.float32), SKY_WIDTH_PX)
    disk = sun_picture(np.asarray(sun), SKY_WIDTH_PX) * sky.sun_radiance.astype(np.float32)
    radiance = radiance + disk
    radiance[SKY_WIDTH_PX // 4 :] = 0
    return np.asarray(radiance, np.float32)


def _joined(above: NDArray[np.float32], below: NDArray[np.float32]) -> NDArray[np.float32]:
    """The sky over the ground, the two fading into each other under the horizon."""
    height = SKY_WIDTH_PX // 2
    elevation = np.degrees(np.arcsin(equirect_directions(SKY_WIDTH_PX, height)[..., 1:2]))
    share = np.clip(-elevation / _HORIZON_DEG, 0, 1).astype(np.float32)
    rim = above[height // 2 - 1][None]
    lower = np.where(elevation < 0, rim, above)
    return np.ascontiguousarray((1 - share) * lower + share * below, np.float32)


def _keep(radiance: NDArray[np.float32], path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    write_environment_map(EnvironmentMap(radiance=np.maximum(radiance, 0)), path)


def _listed(path: Path, category: str) -> TrainingProbe:
    sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
    return TrainingProbe(
        name=path.stem, path=path, category=category, group=path.stem, sha256=sha256
    )

"""Maps of true range without pictures: rendered places, and skies over plain ground.

    OUT/NAME.exr + NAME.json    level, north at the center, in units of the level of LDR white

They are light to train with and to judge with. Each is filed under a place of its own, without a
position, so that none of them is taken for a street that somebody fetched.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture
from panokit.envmap import Anchor, EnvironmentMap
from panokit.frames import Frame
from panokit.io import write_environment_map
from panokit.io.pictures import record_path
from panokit.provenance import Provenance, Step
from panokit.sphere import resize_radiance
from panokit.synthetic.generate import render_truth, sky_of
from panokit.synthetic.photograph import metered_exposure
from panokit.synthetic.render import sun_picture
from panokit.synthetic.settings import VERSION, CitySettings
from panokit.synthetic.shots import Shot, plan_shots
from panokit.synthetic.sky import Weather

# Half of them with a sun, as the rendered places have it.
_SKIES: tuple[Weather, ...] = ("clear", "cloudy", "overcast", "clear", "night", "cloudy")
_GROUND = 0.2


def reference_maps(
    city: CitySettings,
    places: int,
    skies: int,
    out: Path,
    on_done: Callable[[str], None] | None = None,
) -> list[Path]:
    """Make maps of true range; those that are there already are kept.

    Args:
        city: From which seed, how large, how many paths; its count does not matter.
        places: How many rendered places.
        skies: How many skies besides.
        out: The folder.
        on_done: Called with the name of each that was made.

    Returns:
        The maps' files, also those that were kept.

    Raises:
        MissingExtraError: If Mitsuba is not installed.
        StorageError: If the folder cannot be written.
    """
    files = []
    for name, make in _planned(city, places, skies):
        path = Path(out) / f"{name}.exr"
        files.append(path)
        if not record_path(path).exists():
            write_environment_map(make(), path)
            if on_done is not None:
                on_done(name)
    return files


def _planned(
    city: CitySettings, places: int, skies: int
) -> Iterator[tuple[str, Callable[[], EnvironmentMap]]]:
    for shot in plan_shots(city.model_copy(update={"count": places})):
        yield shot.capture.id, lambda shot=shot: _rendered(shot, city)  # type: ignore[misc]
    # Other seeds than the places': no sky stands over two of them.
    weathers = [_SKIES[number % len(_SKIES)] for number in range(skies)]
    for number, weather in enumerate(weathers):
        own = CitySettings(count=number + 1, seed=city.seed + 1, weather=weather)
        shot = plan_shots(own)[number]
        name = f"sky-{weather}-{city.seed}-{number:03d}"
        yield name, lambda shot=shot, name=name: _sky(shot, city, name)  # type: ignore[misc]


def _rendered(shot: Shot, city: CitySettings) -> EnvironmentMap:
    return _with_records(render_truth(shot, city), shot, shot.capture.id, city)


def _sky(shot: Shot, city: CitySettings, name: str) -> EnvironmentMap:
    """The sky as it is, and below it ground that is lit by it."""
    sky = sky_of(shot)
    radiance = resize_radiance(sky.radiance, 2 * city.truth_width_px)
    if sky.sun_direction is not None:
        sun = sun_picture(sky.sun_direction, radiance.shape[1])
        radiance = radiance + sun * sky.sun_radiance.astype(np.float32)
    return _with_records(_on_ground(radiance), shot, name, city)


def _on_ground(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """With matte ground below the horizon: irradiance times albedo over pi."""
    height, width = radiance.shape[:2]
    angle = np.pi * (np.arange(height) + 0.5) / height
    ring = 2 * np.pi / width * np.pi / height * np.sin(angle) * np.maximum(np.cos(angle), 0)
    irradiance = (radiance * ring[:, None, None]).sum(axis=(0, 1))
    grounded = radiance.copy()
    grounded[height // 2 :] = irradiance * _GROUND / np.pi
    return grounded


def _with_records(
    radiance: NDArray[np.float32], shot: Shot, name: str, city: CitySettings
) -> EnvironmentMap:
    exposure = metered_exposure(radiance, night=shot.weather == "night", stops=shot.stops)
    step = Step(
        stage="synthetic",
        version=VERSION,
        settings_digest=city.digest,
        values={"place_seed": shot.place_seed, "weather": shot.weather,
                "exposure": exposure.scale},
    )  # fmt: skip
    scaled = (radiance * np.float32(exposure.scale)).astype(np.float32)
    return EnvironmentMap(
        radiance=resize_radiance(scaled, city.truth_width_px),
        frame=Frame.WORLD,
        anchor=Anchor.LDR_WHITE,
        capture=_nowhere(shot.capture, name),
        provenance=Provenance((step,)),
    )


def _nowhere(capture: Capture, name: str) -> Capture:
    return replace(capture, id=name, place=name, latitude_deg=None, longitude_deg=None)

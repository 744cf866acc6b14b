"""Which panoramas a city has: where, when, under which sky, with which camera pose."""

import math
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

import numpy as np

from panokit.capture import Capture, TimePrecision, license_from_spdx
from panokit.frames import azimuth_elevation_from_direction
from panokit.sun import sun_direction
from panokit.synthetic.city import PlaceKind
from panokit.synthetic.places import plan_place
from panokit.synthetic.settings import CitySettings
from panokit.synthetic.sky import Weather

ATTRIBUTION = "panokit synthetic city"
# In the open Atlantic, so that nobody takes it for a real town.
LATITUDE_DEG, LONGITUDE_DEG = 44.5, -28.0
_KINDS: tuple[PlaceKind, ...] = (
    "old-town", "boulevard", "square", "waterfront", "residential"
)  # fmt: skip
# How far the sun may stand off the line of the street without hiding behind its houses.
_SUN_OFF_STREET_DEG: dict[PlaceKind, float] = {
    "old-town": 14.0, "boulevard": 35.0, "square": 90.0, "waterfront": 90.0, "residential": 60.0
}  # fmt: skip
_NAMES: dict[PlaceKind, tuple[str, ...]] = {
    "old-town": ("Tallow Lane", "Needle Street", "Pepper Alley", "Candle Steps"),
    "boulevard": ("Meridian Boulevard", "Linden Avenue", "Parade of Kites", "Orchard Mile"),
    "square": ("Lantern Square", "Well Market", "Clockmaker Square", "Figtree Place"),
    "waterfront": ("Heron Quay", "Rope Wharf", "Salt Landing", "Tern Embankment"),
    "residential": ("Hawthorn Road", "Plumtree Close", "Wren Crescent", "Mill Rise"),
}
# Half sun, a quarter overcast, a quarter night.
_WEATHERS: tuple[Weather, ...] = (
    "clear", "overcast", "cloudy", "night", "cloudy", "night", "clear", "overcast"
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Shot:
    """One panorama to render.

    Attributes:
        capture: What a street-imagery service would say of it.
        kind: Of its place.
        place_seed: The place's plan is made from.
        weather: Of its sky.
        stops: Exposure compensation.
        seed: For noise and clouds.
    """

    capture: Capture
    kind: PlaceKind
    place_seed: int
    weather: Weather
    stops: float
    seed: int


def plan_shots(settings: CitySettings) -> list[Shot]:
    """The panoramas of a city; shot i is the same whatever the count."""
    return [_shot(settings, index) for index in range(settings.count)]


def _shot(settings: CitySettings, index: int) -> Shot:
    rng = np.random.default_rng([settings.seed, index])
    kind = _KINDS[index % len(_KINDS)]
    names = _NAMES[kind]
    name = names[(settings.seed + index // len(_KINDS)) % len(names)]
    weather = _WEATHERS[index % len(_WEATHERS)] if settings.weather == "mixed" else settings.weather
    latitude_deg = LATITUDE_DEG + 0.002 * (index % len(_KINDS)) + float(rng.uniform(0, 4e-4))
    longitude_deg = LONGITUDE_DEG + 0.003 * (index % len(_KINDS)) + float(rng.uniform(0, 4e-4))
    tilted = rng.random() < 0.4
    place_seed = settings.seed * 1000 + index
    street_azimuth_deg = plan_place(kind, place_seed).street_azimuth_deg
    capture = Capture(
        provider="synthetic",
        id=f"{name.lower().replace(' ', '-')}-{settings.seed}-{index:03d}",
        license=license_from_spdx("CC0-1.0", ATTRIBUTION),
        latitude_deg=round(latitude_deg, 6),
        longitude_deg=round(longitude_deg, 6),
        time=_time(
            rng,
            weather,
            (latitude_deg, longitude_deg),
            street_azimuth_deg,
            _SUN_OFF_STREET_DEG[kind],
        ),
        time_precision=TimePrecision.SECOND,
        heading_deg=round(float(rng.uniform(0, 360)), 2),
        pitch_deg=round(float(rng.uniform(-4, 4)), 2) if tilted else 0.0,
        roll_deg=round(float(rng.uniform(-4, 4)), 2) if tilted else 0.0,
        width_px=settings.width_px,
        height_px=settings.width_px // 2,
        place=name,
        details={"synthetic": True, "weather": weather},
    )
    return Shot(
        capture=capture,
        kind=kind,
        place_seed=place_seed,
        weather=weather,
        stops=float(rng.normal(0, 0.25)),
        seed=settings.seed * 100_000 + index,
    )


def _time(
    rng: np.random.Generator,
    weather: Weather,
    position_deg: tuple[float, float],
    street_azimuth_deg: float,
    off_street_deg: float,
) -> datetime:
    """A time of the year at which this sky can be: the sun in the street by day, set by night."""
    low, high = (-60.0, -12.0) if weather == "night" else (20.0, 58.0)
    while True:
        minute = int(rng.integers(365 * 24 * 60))
        time = datetime(2025, 1, 1, tzinfo=UTC) + timedelta(minutes=minute)
        azimuth, elevation = azimuth_elevation_from_direction(sun_direction(*position_deg, time))
        off_street = (math.degrees(float(azimuth)) - street_azimuth_deg + 90) % 180 - 90
        in_street = weather in ("night", "overcast") or abs(off_street) <= off_street_deg
        if low <= math.degrees(float(elevation)) <= high and in_street:
            return time

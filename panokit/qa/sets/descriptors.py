"""What a map's light is like, in figures that do not depend on its scale or size."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.color.temperature import color_temperature
from panokit.frames import azimuth_elevation_from_direction
from panokit.qa.distribution import anisotropy, upper_share
from panokit.qa.radiometry import clipped_area_percent, dynamic_range_stops, top_share
from panokit.qa.sets.measured import Measured, color_balance
from panokit.sphere import light_vector

# Beside the poles neighboring pixels show the same, whatever the picture.
_POLEWARD_DEG = 60.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Descriptor:
    """One figure of a map.

    Attributes:
        name: Short and stable.
        label: For people.
        unit: Of the figure.
        meaning: What it says, in one plain sentence.
        of: Map -> figure; None where there is none, such as the height of a light in a map
            without lights.
    """

    name: str
    label: str
    unit: str
    meaning: str
    of: Callable[[Measured], float | None]


def describe(measured: Measured) -> dict[str, float | None]:
    """Every figure of `DESCRIPTORS`, by name."""
    return {descriptor.name: descriptor.of(measured) for descriptor in DESCRIPTORS}


def _band(first: int, last: int) -> Callable[[Measured], float]:
    def of(measured: Measured) -> float:
        share = measured.power[first : last + 1].sum() / measured.power[0]
        return float(np.log2(max(share, 2.0**-40)))

    return of


def _spread(measured: Measured, values: NDArray[np.floating]) -> float:
    mean = float((values * measured.weights).sum())
    return float(np.sqrt(max(float((np.square(values) * measured.weights).sum()) - mean**2, 0.0)))


def _light_elevation(measured: Measured) -> float | None:
    vector = light_vector(measured.envmap.radiance)
    if not np.linalg.norm(vector) > 0:
        return None
    return float(np.degrees(azimuth_elevation_from_direction(vector)[1]))


def _light_share(measured: Measured) -> float:
    lights = measured.lights
    total = float(luminance(lights.energy))
    return sum(light.luminance for light in lights.lights) / total if total > 0 else 0.0


def _key_elevation(measured: Measured) -> float | None:
    if not measured.lights.lights:
        return None
    return float(
        np.degrees(azimuth_elevation_from_direction(measured.lights.lights[0].direction)[1])
    )


def _key_radius(measured: Measured) -> float | None:
    if not measured.lights.lights:
        return None
    return float(np.degrees(measured.lights.lights[0].angular_radius))


def _key_to_fill(measured: Measured) -> float | None:
    ratio = measured.lights.key_to_fill
    return float(np.log2(min(ratio, 1e6))) if ratio > 0 else None


def _key_warmth(measured: Measured) -> float | None:
    lights = measured.lights
    if not lights.lights or luminance(lights.ambient) <= 0:
        return None
    return float(
        color_balance(lights.lights[0].energy, "red") - color_balance(lights.ambient, "red")
    )


def _ambient_mired(measured: Measured) -> float | None:
    found = color_temperature(measured.lights.ambient)
    return 1e6 / found.kelvin if found else None


def _detail(measured: Measured) -> float:
    height = measured.envmap.height_px
    first = round(height * (90 - _POLEWARD_DEG) / 180)
    rows = measured.stops[first : height - first]
    return float(np.abs(rows - np.roll(rows, 1, axis=1)).mean())


DESCRIPTORS: tuple[Descriptor, ...] = (
    Descriptor(
        name="peak-over-median",
        label="Peak over median",
        unit="stops",
        meaning="How far the brightest pixel stands above the median.",
        of=lambda m: dynamic_range_stops(m.envmap),
    ),
    Descriptor(
        name="highlights",
        label="Highlights",
        unit="stops",
        meaning="From the median to the 99th percentile: bright areas without the sun.",
        of=lambda m: m.percentile(99) - m.percentile(50),
    ),
    Descriptor(
        name="shadows",
        label="Shadows",
        unit="stops",
        meaning="From the 1st percentile to the median.",
        of=lambda m: m.percentile(50) - m.percentile(1),
    ),
    Descriptor(
        name="contrast",
        label="Contrast",
        unit="stops",
        meaning="Standard deviation of luminance over the sphere, in stops.",
        of=lambda m: _spread(m, m.stops),
    ),
    Descriptor(
        name="top-share",
        label="Energy of the top 0.1 %",
        unit="",
        meaning="The share of the energy that comes from the brightest 0.1 % of the sphere.",
        of=lambda m: top_share(m.envmap),
    ),
    Descriptor(
        name="plateau",
        label="Flat top",
        unit="%",
        meaning="The share of the sphere within 1 % of the maximum; radiance that was cut off.",
        of=lambda m: clipped_area_percent(m.envmap),
    ),
    Descriptor(
        name="anisotropy",
        label="Anisotropy",
        unit="",
        meaning="0 for light from everywhere, 1 for one small lamp.",
        of=lambda m: anisotropy(m.envmap),
    ),
    Descriptor(
        name="upper-share",
        label="Light from above",
        unit="",
        meaning="The share of the energy that comes from above the horizon.",
        of=lambda m: upper_share(m.envmap),
    ),
    Descriptor(
        name="light-elevation",
        label="Height of the light",
        unit="°",
        meaning="How high the light vector points: where light comes from on the whole.",
        of=_light_elevation,
    ),
    *(
        Descriptor(
            name=f"degree-{name}",
            label=f"Harmonics of degree {label}",
            unit="stops",
            meaning="Power of the luminance in this degree over that of its mean, as log2.",
            of=_band(first, last),
        )
        for name, label, first, last in (
            ("1", "1", 1, 1),
            ("2", "2", 2, 2),
            ("3-4", "3 to 4", 3, 4),
            ("5-8", "5 to 8", 5, 8),
            ("9-16", "9 to 16", 9, 16),
        )
    ),
    Descriptor(
        name="lights",
        label="Lights",
        unit="",
        meaning="How many sources give a hundredth of the light or more.",
        of=lambda m: float(len(m.lights.lights)),
    ),
    Descriptor(
        name="light-share",
        label="Energy of the lights",
        unit="",
        meaning="The share of the energy that comes from these sources.",
        of=_light_share,
    ),
    Descriptor(
        name="key-elevation",
        label="Height of the strongest light",
        unit="°",
        meaning="Its elevation above the horizon.",
        of=_key_elevation,
    ),
    Descriptor(
        name="key-radius",
        label="Size of the strongest light",
        unit="°",
        meaning="The radius of a disk of its solid angle: small lights cast hard shadows.",
        of=_key_radius,
    ),
    Descriptor(
        name="key-to-fill",
        label="Key to fill",
        unit="stops",
        meaning="What the strongest light gives a surface facing it, over all other light there.",
        of=_key_to_fill,
    ),
    Descriptor(
        name="key-warmth",
        label="Warmth of the strongest light",
        unit="stops",
        meaning="Red over blue of the strongest light, over the same of the ambient light.",
        of=_key_warmth,
    ),
    Descriptor(
        name="ambient-warmth",
        label="Warmth of the ambient light",
        unit="stops",
        meaning="Red over blue of the light without its sources.",
        of=lambda m: float(color_balance(m.lights.ambient, "red")),
    ),
    Descriptor(
        name="ambient-green",
        label="Green of the ambient light",
        unit="stops",
        meaning="Green over magenta of the light without its sources.",
        of=lambda m: float(color_balance(m.lights.ambient, "green")),
    ),
    Descriptor(
        name="ambient-temperature",
        label="Temperature of the ambient light",
        unit="mired",
        meaning="A million over its correlated color temperature; 154 is daylight of 6500 K.",
        of=_ambient_mired,
    ),
    Descriptor(
        name="color-contrast",
        label="Color contrast",
        unit="stops",
        meaning="Standard deviation of red over blue over the sphere.",
        of=lambda m: _spread(m, color_balance(m.envmap.radiance, "red")),
    ),
    Descriptor(
        name="detail",
        label="Detail",
        unit="stops",
        meaning="Mean step from a pixel to its neighbor: blurred or painted maps have less.",
        of=_detail,
    ),
)

"""Figures about the sources of light in a map, and what expansion did to them."""

from itertools import combinations

import numpy as np

from panokit.color.luminance import luminance
from panokit.frames import angle_between
from panokit.qa.measurements import Finding, Measurements, absent
from panokit.sphere import Light

# Sources wider than this are windows; two of them are often alike.
_SMALL = np.deg2rad(2.5)
# Twins agree so well, in octaves, in energy, in each channel of their color, and in width.
_TWIN_ENERGY, _TWIN_COLOR, _TWIN_WIDTH = 0.5, 0.1, 0.9
_DARKEST_CHANNEL = 1e-6


def source_share(measured: Measurements) -> Finding:
    """The share of the light that comes from sources; the rest is ambient."""
    if measured.is_black:
        return absent("the map is black")
    found = measured.lights
    from_sources = sum(light.luminance for light in found.lights)
    note = f"{len(found.lights)} sources" if len(found.lights) != 1 else "1 source"
    if found.abstained:
        note += f", none dominant ({found.abstained})"
    return Finding(value=min(from_sources / measured.total, 1.0), note=note)


def twin_source(measured: Measurements) -> Finding:
    """The share of the light of the weaker of two small sources that are as good as equal.

    There is one sun. A panorama that shows it twice was stitched from pictures of a moving
    camera, or had it copied into a hole. Lamps come in equal pairs too, but then each gives
    little of the light.
    """
    if measured.is_black:
        return absent("the map is black")
    lights = measured.lights.lights
    small = [light for light in lights if light.angular_radius < _SMALL]
    twins = [pair for pair in combinations(small, 2) if _are_twins(*pair)]
    weaker = max((min(a.luminance, b.luminance) for a, b in twins), default=0.0)
    return Finding(value=weaker / measured.total)


def expansion_gain(measured: Measurements) -> Finding:
    """The luminance of all light after expansion over that of the panorama before."""
    step = measured.step("expand")
    if step is None:
        return absent("the map was not expanded")
    try:
        before = float(luminance(np.asarray(step.values["energy_before"], np.float64)))
        after = float(luminance(np.asarray(step.values["energy_after"], np.float64)))
        scale = float(step.values.get("scale", {}).get("factor", 1.0))
    except (KeyError, TypeError, ValueError, AttributeError):
        return absent("expansion did not record the energy")
    if before <= 0 or scale <= 0:
        return absent("there was no light before")
    return Finding(value=after / (before * scale), note=_burnt(step.values.get("burnt_share")))


def recorded_light(measured: Measurements) -> Finding:
    """The angle between the strongest recorded light and the nearest light in the map.

    A map that was turned or flipped after its record was written shows it here.
    """
    step = measured.step("expand")
    try:
        recorded = step.values["lighting"]["lights"] if step else []
        direction = np.asarray(recorded[0]["direction"], np.float64) if recorded else None
    except (KeyError, TypeError, ValueError, IndexError):
        direction = None
    if direction is None or direction.shape != (3,):
        return absent("no lights are recorded")
    if measured.is_black or not measured.lights.lights:
        return absent("there are no lights in the map")
    angles = [float(angle_between(light.direction, direction)) for light in measured.lights.lights]
    return Finding(value=float(np.degrees(min(angles))))


def _are_twins(a: Light, b: Light) -> bool:
    colors = [np.maximum(light.color, _DARKEST_CHANNEL) for light in (a, b)]
    return bool(
        abs(np.log2(a.luminance / b.luminance)) < _TWIN_ENERGY
        and np.abs(np.log2(colors[0] / colors[1])).max() < _TWIN_COLOR
        and abs(np.log2(a.angular_radius / b.angular_radius)) < _TWIN_WIDTH
    )


def _burnt(share: object) -> str:
    return f"{100 * share:.2g} % were burnt out" if isinstance(share, int | float) else ""

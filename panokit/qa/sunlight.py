"""The sun in the map against the sun in the sky: a check of position, heading, time, and frame.

Where and when a picture was taken says where the sun stood. If the map's sun stands elsewhere,
the way it is off tells why: a clock that is wrong by whole hours, a heading that is wrong by
half a turn, a picture that is flipped left to right.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture, TimePrecision
from panokit.frames import Frame, angle_between, azimuth_elevation_from_direction
from panokit.qa.measurements import Finding, Measurements, absent
from panokit.qa.sun_hypotheses import Hypothesis, best_clock, explanations
from panokit.sphere import Light
from panokit.sun import sun_bounds, sun_direction

# A sun is narrower than this, glare and all, and gives this share of the light.
_WIDEST = np.deg2rad(6.0)
_LEAST_SHARE = 0.05
# On a surface that faces it, it gives at least this much of what everything else gives.
_LEAST_KEY_TO_FILL = 0.3
# Where a picture had burnt out around the sun, its light is spread; then it must dominate.
_WIDEST_SPREAD, _KEY_TO_FILL_OF_SPREAD = np.deg2rad(13.0), 1.0
# Behind haze it may be outshone by a bright cloud; it still has this much of the strongest light.
_LEAST_OF_STRONGEST = 0.35
# Lower than this the sun is behind something, and refraction is uncertain.
_LOWEST_DEG = 2.0
# The largest that a sun comes out as on captured maps; what is wider is glare.
_SUN_RADIUS_DEG = 1.0
# This near to where it should be, nothing has to be explained.
_NEAR_DEG = 6.0


@dataclass(frozen=True, slots=True, kw_only=True)
class _Sighting:
    """The sun as the map shows it, with the capture that says where it should be."""

    direction: NDArray[np.float64]
    radius: float
    capture: Capture
    latitude_deg: float
    longitude_deg: float


def sun_place(measured: Measurements) -> Finding:
    """The angle in degrees between the map's sun and where it stood, after a clock error if any.

    The note names what would explain a large one.
    """
    seen = _sighting(measured, needs_second=True)
    if isinstance(seen, str):
        return absent(seen)
    angle, hypothesis = _explained(seen)
    note = "" if hypothesis.hours == 0 else f"after {hypothesis}"
    if angle > _NEAR_DEG:
        found = explanations(seen.direction, _expected(seen), _allowance_deg(seen))
        note = f"it would fit {found}" if found else "no simple error explains it"
    return Finding(value=angle, note=note)


def sun_clock(measured: Measurements) -> Finding:
    """By how many hours the clock seems wrong: the error of a time zone that explains the sun.

    0 where the recorded time fits, or where no such error explains the sun either.
    """
    seen = _sighting(measured, needs_second=True)
    if isinstance(seen, str):
        return absent(seen)
    _, hypothesis = _explained(seen)
    if hypothesis.hours == 0:
        return Finding(value=0.0)
    others = explanations(seen.direction, _expected(seen), _allowance_deg(seen))
    note = str(hypothesis) + (f"; or {others}" if others else "")
    return Finding(value=abs(hypothesis.hours), note=note)


def sun_date(measured: Measurements) -> Finding:
    """By how many degrees the map's sun stands outside all places it can have on that date.

    For pictures of which only the day, the month or the year is known, as those of Street View.
    """
    seen = _sighting(measured, needs_second=False)
    if isinstance(seen, str):
        return absent(seen)
    time, precision = seen.capture.time, seen.capture.time_precision
    if time is None or precision is None:
        return absent("the time is not known")
    if precision is TimePrecision.SECOND:
        return absent("the time is known: see the sun's place")
    bounds = sun_bounds(seen.latitude_deg, time, precision)
    rising = np.degrees(bounds.northernmost_rising)
    note = (
        f"then up to {np.degrees(bounds.highest_elevation):.0f}° high, "
        f"rising no farther north than {rising:.0f}°"
    )
    return Finding(value=float(np.degrees(bounds.excess(seen.direction))), note=note)


def suns_of(measured: Measurements) -> tuple[Light, ...]:
    """The lights that may be the sun, strongest first: small, high enough, and strong."""
    found = measured.lights
    if not found.lights or found.key_to_fill < _LEAST_KEY_TO_FILL:
        return ()
    least = max(_LEAST_SHARE * measured.total, _LEAST_OF_STRONGEST * found.lights[0].luminance)
    dominates = found.key_to_fill >= _KEY_TO_FILL_OF_SPREAD
    return tuple(
        light
        for number, light in enumerate(found.lights)
        if light.luminance >= least
        and light.angular_radius <= (_WIDEST_SPREAD if dominates and number == 0 else _WIDEST)
        and light.direction[1] > np.sin(np.deg2rad(_LOWEST_DEG))
    )


def _sighting(measured: Measurements, *, needs_second: bool) -> _Sighting | str:
    """The sun and what is known of it, or why nothing can be said."""
    capture = measured.capture
    if measured.envmap.frame is not Frame.WORLD:
        return "the map's north is not known"
    if capture is None or capture.time is None:
        return "the time is not known"
    if capture.latitude_deg is None or capture.longitude_deg is None:
        return "the place is not known"
    if needs_second and capture.time_precision is not TimePrecision.SECOND:
        return f"only the {capture.time_precision} is known"
    if measured.is_black:
        return "the map is black"
    suns = suns_of(measured)
    if not suns:
        return "no sun in the map"
    seen = _Sighting(
        direction=suns[0].direction,
        radius=suns[0].angular_radius,
        capture=capture,
        latitude_deg=capture.latitude_deg,
        longitude_deg=capture.longitude_deg,
    )
    if needs_second and _expected(seen)[1] < np.sin(np.deg2rad(_LOWEST_DEG)):
        elevation = np.degrees(azimuth_elevation_from_direction(_expected(seen))[1])
        return f"the sun stood {elevation:.0f}° high: too low to be seen"
    if needs_second:
        each = [replace(seen, direction=s.direction, radius=s.angular_radius) for s in suns]
        nearest = min(each, key=_off_deg)
        return nearest if _off_deg(nearest) <= _NEAR_DEG else seen
    return seen


def _expected(seen: _Sighting) -> NDArray[np.float64]:
    time = seen.capture.time
    if time is None:
        return np.zeros(3)
    return sun_direction(seen.latitude_deg, seen.longitude_deg, time)


def _off_deg(seen: _Sighting) -> float:
    """The angle to where the sun stood, less the radius of a light that is wider than a sun."""
    angle = float(np.degrees(angle_between(seen.direction, _expected(seen))))
    return max(angle - _allowance_deg(seen), 0.0)


def _allowance_deg(seen: _Sighting) -> float:
    return max(float(np.degrees(seen.radius)) - _SUN_RADIUS_DEG, 0.0)


def _explained(seen: _Sighting) -> tuple[float, Hypothesis]:
    """The angle that is left, and the clock error that was taken off."""
    angle = _off_deg(seen)
    none = Hypothesis(hours=0.0, words="")
    if angle <= _NEAR_DEG or seen.capture.time is None:
        return angle, none
    found = best_clock(seen.direction, seen.latitude_deg, seen.longitude_deg, seen.capture.time)
    return (angle, none) if found is None else found

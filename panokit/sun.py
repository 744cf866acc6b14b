"""Where the sun stands, from place and time; and where it can stand when only a date is known."""

import math
from calendar import monthrange
from dataclasses import dataclass
from datetime import datetime, timedelta

import numpy as np
from astral import Observer
from astral.julian import julianday, julianday_to_juliancentury
from astral.sun import azimuth, elevation
from astral.sun import sun_declination as _astral_declination
from numpy.typing import NDArray

from panokit.capture import TimePrecision
from panokit.errors import UsageError
from panokit.frames import direction_from_azimuth_elevation

# Seen from the Earth, on average over the year.
SUN_RADIUS = math.radians(0.5332 / 2)
SUN_SOLID_ANGLE = 2 * math.pi * (1 - math.cos(SUN_RADIUS))
# The tilt of the Earth's axis: the sun is never farther from the equator.
OBLIQUITY = math.radians(23.44)


@dataclass(frozen=True, slots=True, kw_only=True)
class SunBounds:
    """Where the sun can stand at a place between two dates; all angles in radians.

    Attributes:
        latitude: Of the place.
        declination_low: The least declination, the sun's latitude among the stars.
        declination_high: The largest.
    """

    latitude: float
    declination_low: float
    declination_high: float

    @property
    def highest_elevation(self) -> float:
        """The highest it can stand, at noon of the best day."""
        nearest = min(max(self.latitude, self.declination_low), self.declination_high)
        return math.pi / 2 - abs(self.latitude - nearest)

    @property
    def northernmost_rising(self) -> float:
        """The azimuth from 0 to pi of the rising nearest to north; 0 under a midnight sun."""
        cosine = math.sin(self.declination_high) / max(math.cos(self.latitude), 1e-9)
        return math.acos(min(max(cosine, -1.0), 1.0))

    def excess(self, direction: NDArray[np.floating]) -> float:
        """By how much a direction lies outside, as declination; 0 within. World frame, (3,)."""
        found = declination_of(direction, self.latitude)
        return max(self.declination_low - found, found - self.declination_high, 0.0)


def sun_direction(latitude_deg: float, longitude_deg: float, time: datetime) -> NDArray[np.float64]:
    """The unit direction toward the sun, (3,), in the world frame; below the horizon at night.

    By astral's solar equations (after NOAA), refraction included; good to a few hundredths
    of a degree.

    Raises:
        UsageError: If the time has no timezone.
    """
    if time.tzinfo is None:
        raise UsageError("The sun's place needs a time with a timezone; use UTC.")
    observer = Observer(latitude_deg, longitude_deg)
    return np.asarray(
        direction_from_azimuth_elevation(
            math.radians(azimuth(observer, time)), math.radians(elevation(observer, time))
        )
    )


def sun_declination(time: datetime) -> float:
    """The sun's declination in radians: positive in the northern summer."""
    return math.radians(_astral_declination(julianday_to_juliancentury(julianday(time))))


def declination_of(direction: NDArray[np.floating], latitude: float) -> float:
    """The declination, in radians, of a direction of the world frame at a latitude in radians.

    sin(declination) = sin(latitude) sin(elevation) + cos(latitude) cos(elevation) cos(azimuth);
    the product of the last two is the direction's northern part, -z.
    """
    sine = math.sin(latitude) * float(direction[1]) - math.cos(latitude) * float(direction[2])
    return math.asin(min(max(sine, -1.0), 1.0))


def sun_bounds(latitude_deg: float, time: datetime, precision: TimePrecision) -> SunBounds:
    """Where the sun can have stood when a time is known to the day, the month or the year.

    A day is taken with its neighbors, since the date may be that of another time zone.
    """
    if precision is TimePrecision.YEAR:
        low, high = -OBLIQUITY, OBLIQUITY
    else:
        first = time
        days = 1
        if precision is TimePrecision.MONTH:
            first = time.replace(day=1)
            days = monthrange(time.year, time.month)[1]
        around = [sun_declination(first + timedelta(days=d)) for d in range(-1, days + 1)]
        low, high = min(around), max(around)
    return SunBounds(
        latitude=math.radians(latitude_deg), declination_low=low, declination_high=high
    )

"""Where the sun stands, from place and time."""

import math
from datetime import datetime

import numpy as np
from astral import Observer
from astral.sun import azimuth, elevation
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import direction_from_azimuth_elevation

# Seen from the Earth, on average over the year.
SUN_RADIUS = math.radians(0.5332 / 2)
SUN_SOLID_ANGLE = 2 * math.pi * (1 - math.cos(SUN_RADIUS))


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

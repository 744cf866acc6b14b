from datetime import UTC, datetime

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.frames import azimuth_elevation_from_direction
from panokit.sun import sun_direction


@pytest.mark.parametrize(
    ("place", "time", "azimuth_deg", "elevation_deg"),
    [
        # Strasbourg, an afternoon in May, by two independent almanacs.
        ((48.50179, 7.731916), datetime(2022, 5, 30, 15, 23, 19, tzinfo=UTC), 262.1, 36.5),
        ((48.50179, 7.731916), datetime(2022, 5, 30, 17, 23, 19, tzinfo=UTC), 284.3, 16.8),
        # The equator at the equinox: overhead at noon.
        ((0.0, 0.0), datetime(2024, 3, 20, 12, 7, tzinfo=UTC), None, 89.7),
    ],
)
def test_the_sun_stands_where_the_almanac_says(place, time, azimuth_deg, elevation_deg):
    direction = sun_direction(*place, time)
    azimuth, elevation = np.rad2deg(azimuth_elevation_from_direction(direction))
    assert elevation == pytest.approx(elevation_deg, abs=0.35)
    if azimuth_deg is not None:
        assert azimuth % 360 == pytest.approx(azimuth_deg, abs=0.15)


def test_at_midnight_it_is_below_the_horizon():
    assert sun_direction(48.5, 7.7, datetime(2022, 12, 1, 0, 0, tzinfo=UTC))[1] < 0


def test_a_time_without_a_zone_names_no_moment():
    with pytest.raises(UsageError, match="UTC"):
        sun_direction(48.5, 7.7, datetime(2022, 5, 30, 15, 23))

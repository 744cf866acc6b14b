from datetime import UTC, datetime

import numpy as np
import pytest

from panokit.capture import TimePrecision
from panokit.errors import UsageError
from panokit.frames import azimuth_elevation_from_direction
from panokit.sun import declination_of, sun_bounds, sun_declination, sun_direction


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


def test_the_declination_of_the_sun_is_that_of_its_direction():
    time = datetime(2024, 6, 21, 9, 0, tzinfo=UTC)
    found = declination_of(sun_direction(48.5, 7.7, time), np.deg2rad(48.5))
    assert np.degrees(sun_declination(time)) == pytest.approx(23.43, abs=0.02)
    assert np.degrees(found) == pytest.approx(23.43, abs=0.05)


@pytest.mark.parametrize(
    ("month", "highest_deg", "rising_deg"), [(6, 64.9, 53), (12, 20.0, 124), (3, 45.9, 83)]
)
def test_a_month_bounds_the_sun(month, highest_deg, rising_deg):
    bounds = sun_bounds(48.5, datetime(2024, month, 15, tzinfo=UTC), TimePrecision.MONTH)
    assert np.degrees(bounds.highest_elevation) == pytest.approx(highest_deg, abs=0.6)
    assert np.degrees(bounds.northernmost_rising) == pytest.approx(rising_deg, abs=1.5)


def test_within_the_bounds_nothing_is_in_excess_and_beyond_it_is_degrees():
    june = sun_bounds(48.5, datetime(2024, 6, 15, tzinfo=UTC), TimePrecision.MONTH)
    year = sun_bounds(48.5, datetime(2024, 6, 15, tzinfo=UTC), TimePrecision.YEAR)
    summer = sun_direction(48.5, 7.7, datetime(2024, 6, 15, 13, 0, tzinfo=UTC))
    winter = sun_direction(48.5, 7.7, datetime(2024, 12, 15, 11, 0, tzinfo=UTC))
    assert np.degrees(june.excess(summer)) == pytest.approx(0, abs=0.1)
    assert np.degrees(june.excess(winter)) == pytest.approx(45, abs=2)
    assert np.degrees(year.excess(winter)) == pytest.approx(0, abs=0.1)


def test_in_the_far_north_the_sun_need_not_rise():
    june = sun_bounds(78.0, datetime(2024, 6, 15, tzinfo=UTC), TimePrecision.DAY)
    assert june.northernmost_rising == 0

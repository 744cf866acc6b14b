"""Where and when: clusters, cells, months and hours by the sun."""

from dataclasses import replace
from datetime import UTC, datetime

import pytest

from panokit.capture import TimePrecision
from panokit.qa.sets.places import (
    cell_of,
    distance_m,
    month_of,
    near_on_the_ground,
    solar_hour_of,
    spread_of,
)

_DEG_PER_M = 1 / 111_195


def at(capture, north_m=0.0, east_m=0.0, **changes):
    return replace(
        capture,
        latitude_deg=north_m * _DEG_PER_M,
        longitude_deg=10 + east_m * _DEG_PER_M,
        **changes,
    )


def test_chains_of_short_steps_are_one_cluster(capture):
    row = [at(capture, east_m=40 * i) for i in range(5)] + [at(capture, east_m=1000)]
    found = spread_of([*row, None])
    assert (found.located, found.clusters, found.largest_cluster) == (6, 2, 5)
    assert found.cells in (2, 3)


def test_maps_without_places_are_in_no_count(capture):
    lost = replace(capture, latitude_deg=None, longitude_deg=None)
    found = spread_of([lost, None])
    assert found.located == found.clusters == found.cells == 0
    assert spread_of([]).to_json()["cities"] == {}


def test_cities_are_counted(capture):
    found = spread_of([at(capture, place="Oslo"), at(capture, place="Oslo"), at(capture)])
    assert found.cities == {"Oslo": 2}


@pytest.mark.parametrize("latitude_deg", [0, 48.5, -70, 89.999, 90, -90])
def test_cells_are_about_a_kilometer_wide_anywhere(latitude_deg):
    east = 3000 * _DEG_PER_M / max(1e-6, abs(1 - (latitude_deg / 90) ** 2) ** 0.5)
    assert cell_of(latitude_deg, 10) == cell_of(latitude_deg, 10)
    if abs(latitude_deg) < 80:
        assert cell_of(latitude_deg, 10) != cell_of(latitude_deg, 10 + east)
        assert cell_of(latitude_deg, 10) != cell_of(latitude_deg + 0.02, 10)
    assert cell_of(latitude_deg, 180) and cell_of(latitude_deg, -180)


def test_hours_are_those_of_the_sun_and_known_only_by_the_second(capture):
    noon = datetime(2024, 7, 3, 12, 0, tzinfo=UTC)
    known = replace(capture, time=noon, time_precision=TimePrecision.SECOND, longitude_deg=45.0)
    assert (solar_hour_of(known), month_of(known)) == ("15", "07")
    for precision, month in ((TimePrecision.MONTH, "07"), (TimePrecision.YEAR, "")):
        vague = replace(known, time_precision=precision)
        assert (solar_hour_of(vague), month_of(vague)) == ("", month)
    assert solar_hour_of(replace(known, longitude_deg=None)) == ""
    assert spread_of([known]).solar_hours == {"15": 1}


def test_distances_on_the_ground(capture):
    one, other = at(capture), at(capture, north_m=300, east_m=400)
    assert distance_m(one, other) == pytest.approx(500, rel=1e-3)
    assert distance_m(one, None) is None
    assert near_on_the_ground([one, None, other], 600) == [(0, 2)]
    assert near_on_the_ground([one, None, other], 400) == []

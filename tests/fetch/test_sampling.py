"""Sample points: the same every time, all inside, evenly spread."""

from itertools import islice

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from panokit.fetch.cities import find_city
from panokit.fetch.geodesy import distance_m, east_north_m, offset
from panokit.fetch.places import box, disc
from panokit.fetch.sampling import sample_points

BRISTOL = find_city("Bristol, GB")
PINNED = (51.447169, -2.615935)


def first(count, place=BRISTOL, seed=0):
    return list(islice(sample_points(place, seed), count))


def test_more_points_leave_the_first_ones_where_they_are():
    assert first(500)[:50] == first(50)


def test_points_are_pinned():
    # These decide which pictures a run fetches; they may only change with the stage's version.
    (latitude, longitude) = first(1)[0]
    assert (round(latitude, 6), round(longitude, 6)) == PINNED


def test_seed_and_place_give_other_points():
    assert not set(first(50)) & set(first(50, seed=1))
    assert not set(first(50)) & set(first(50, disc("Other", *BRISTOL.center_deg, 4000)))


def test_every_point_lies_in_its_place():
    for place in (BRISTOL, box("b", (10.0, 59.0, 10.2, 59.05)), disc("fiji", -17.0, 179.99, 5000)):
        assert all(place.contains(point) for point in first(300, place))


def test_points_are_even():
    points = np.array([east_north_m(BRISTOL.center_deg, point) for point in first(1600)])
    angle = np.arctan2(points[:, 1], points[:, 0])
    area = np.sum(points**2, axis=1) / BRISTOL.half_width_m**2
    cells = np.histogram2d(angle, area, bins=4, range=[[-np.pi, np.pi], [0, 1]])[0]
    # Independent random points would differ from 100 by 10; these come far closer.
    assert np.abs(cells - 100).max() <= 10


@given(st.floats(-80, 80), st.floats(-180, 179.9), st.floats(-5000, 5000), st.floats(-5000, 5000))
def test_offsets_and_distances_agree(latitude, longitude, east_m, north_m):
    moved = offset((latitude, longitude), east_m, north_m)
    back = east_north_m((latitude, longitude), moved)
    assert np.allclose(back, (east_m, north_m), atol=1e-3)
    assert np.isclose(
        distance_m((latitude, longitude), moved), np.hypot(east_m, north_m), atol=1e-3
    )


def test_a_known_distance():
    # A degree of latitude on a sphere of 6371.0088 km.
    assert round(distance_m((48.0, 7.0), (49.0, 7.0))) == 111195

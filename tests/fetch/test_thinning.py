"""How many pictures of the same: distance, cell, sequence, month."""

from datetime import UTC, datetime

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from panokit.capture import Capture, TimePrecision, license_from_spdx
from panokit.fetch import FetchSettings
from panokit.fetch.geodesy import distance_m, offset
from panokit.fetch.places import disc
from panokit.fetch.thinning import Thinning, cell_of

CENTER = (48.5, 7.7)
PLACE = disc("P", *CENTER, 2000)
LICENSE = license_from_spdx("CC-BY-4.0", "me")


def picture(name, east_m=0.0, sequence="", month=None, place="", **more):
    latitude, longitude = offset(CENTER, east_m, 0)
    return Capture(
        provider="t",
        id=name,
        license=LICENSE,
        latitude_deg=latitude,
        longitude_deg=longitude,
        time=datetime(2024, month, 3, tzinfo=UTC) if month else None,
        time_precision=TimePrecision.DAY if month else None,
        place=place,
        details={"sequence": sequence} if sequence else {},
        **more,
    )


def objections(*pictures, on_disk=(), **limits):
    thinning = Thinning(FetchSettings(**limits), PLACE, on_disk)
    told = []
    for one in pictures:
        told.append(thinning.objection(one))
        if not told[-1]:
            thinning.take(one)
    return told


def test_distance():
    pictures = [picture("a"), picture("b", 24), picture("c", 26), picture("d", 30)]
    assert objections(*pictures, min_distance_m=25) == ["", "too-close", "", "too-close"]
    assert objections(*pictures, min_distance_m=0) == [""] * 4


def test_one_of_a_drive():
    pictures = [picture(str(i), 100 * i, sequence="s" if i < 3 else "t") for i in range(4)]
    assert objections(*pictures, per_sequence=2) == ["", "", "same-sequence", ""]


def test_one_of_a_month():
    pictures = [picture(str(i), 100 * i, month=month) for i, month in enumerate([5, 5, 6])]
    assert objections(*pictures, per_month=1) == ["", "same-month", ""]


def test_what_is_not_known_is_no_objection():
    pictures = [picture("a"), picture("b", 100), picture("c", 200)]
    assert objections(*pictures, per_month=1, per_sequence=1) == [""] * 3


def test_a_year_is_no_month():
    year = {"time": datetime(2024, 1, 1, tzinfo=UTC), "time_precision": TimePrecision.YEAR}
    one = Capture(
        provider="t", id="a", license=LICENSE, latitude_deg=48.5, longitude_deg=7.7, **year
    )
    two = Capture(
        provider="t", id="b", license=LICENSE, latitude_deg=48.6, longitude_deg=7.7, **year
    )
    assert objections(one, two, per_month=1) == ["", ""]


def test_what_is_on_disk_counts_for_its_own_place():
    here = picture("a", place="P", sequence="s")
    assert objections(picture("b", 100, sequence="s"), on_disk=[here], per_sequence=1) == [
        "same-sequence"
    ]
    far = Capture(
        provider="t", id="f", license=LICENSE, latitude_deg=10.0, longitude_deg=7.7,
        place="Elsewhere", details={"sequence": "s"},
    )  # fmt: skip
    assert objections(picture("b", 100, sequence="s"), on_disk=[far], per_sequence=1) == [""]


def test_distances_are_kept_to_other_places_too():
    other = picture("a", place="Q")
    assert objections(picture("b", 10), on_disk=[other], min_distance_m=25) == ["too-close"]


def test_one_of_a_cell():
    thinned = objections(*(picture(str(i), 30.0 * i) for i in range(20)), cell_m=200)
    # 600 m of street touch three or four cells of 200 m.
    assert 3 <= thinned.count("") <= 4
    assert set(thinned) == {"", "same-cell"}


@pytest.mark.parametrize("latitude", [0.0, 48.5, -33.0, 69.0])
def test_cells_are_about_square(latitude):
    rng = np.random.default_rng(0)
    points = [offset((latitude, 20.0), *rng.uniform(0, 5000, 2)) for _ in range(4000)]
    cells = {}
    for point in points:
        cells.setdefault(cell_of(point, 500), []).append(point)
    spans = [max(distance_m(a, b) for a in cell for b in cell) for cell in cells.values()]
    assert 100 <= len(cells) <= 132
    assert max(spans) < 500 * 2**0.5 + 5


@given(
    st.floats(-80, 80),
    st.floats(-179, 179),
    st.floats(-60, 60),
    st.floats(-60, 60),
    st.floats(1, 50),
)
def test_no_two_pictures_are_closer_than_said(latitude, longitude, east_m, north_m, apart_m):
    settings = FetchSettings(min_distance_m=apart_m)
    here, there = (latitude, longitude), offset((latitude, longitude), east_m, north_m)
    # At the very limit the rounding of two sums decides.
    assume(abs(distance_m(there, here) - apart_m) > 1e-6)
    thinning = Thinning(settings, None, ())
    at = [
        Capture(provider="t", id=name, license=LICENSE, latitude_deg=p[0], longitude_deg=p[1])
        for name, p in (("a", here), ("b", there))
    ]
    thinning.take(at[0])
    assert (thinning.objection(at[1]) == "too-close") == (distance_m(there, here) < apart_m)

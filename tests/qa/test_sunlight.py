"""The map's sun against the sky's: right, and wrong in each way that has a name."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from panokit.capture import Capture, TimePrecision, license_from_spdx
from panokit.envmap import EnvironmentMap
from panokit.frames import Frame
from panokit.qa import Verdict, check
from panokit.sphere import equirect_directions
from panokit.sun import sun_direction

PLACE = (48.5, 7.7)
TIME = datetime(2024, 6, 10, 8, 20, tzinfo=UTC)


def lit_by(direction, sun=3e4, width=512):
    directions = equirect_directions(width, width // 2)
    sky = np.where(directions[..., 1:2] > 0, [0.4, 0.6, 1.0], [0.2, 0.18, 0.15])
    glow = np.exp((directions @ direction - 1) * 2e4)[..., None]
    return (sky + sun * glow).astype(np.float32)


def sunny(direction=None, *, time=TIME, precision=TimePrecision.SECOND, frame=Frame.WORLD, **more):
    if direction is None:
        direction = sun_direction(*PLACE, TIME)
    capture = Capture(
        provider="test", id="1", license=license_from_spdx("CC0-1.0", ""),
        **{"latitude_deg": PLACE[0], "longitude_deg": PLACE[1], "time": time,
           "time_precision": precision if time else None, **more},
    )  # fmt: skip
    return EnvironmentMap(radiance=lit_by(direction), frame=frame, capture=capture)


def of(envmap, name):
    return next(c for c in check(envmap).checks if c.name == name)


def test_a_sun_in_its_place_passes():
    place, clock = (of(sunny(), name) for name in ("sun-place", "sun-clock"))
    assert place.verdict is Verdict.PASS
    assert place.value < 0.5
    assert clock.value == 0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda pixels: pixels[:, ::-1], "flipped left to right"),
        (lambda pixels: np.roll(pixels, 256, axis=1), "heading off by 180°"),
    ],
)
def test_a_flip_and_a_half_turn_fail_and_are_named(change, words):
    envmap = sunny()
    changed = envmap.with_changes(radiance=np.ascontiguousarray(change(envmap.radiance)))
    place = of(changed, "sun-place")
    assert place.verdict is Verdict.FAIL
    assert words in place.note


@pytest.mark.parametrize("hours", [1, -2])
def test_a_clock_that_is_wrong_by_hours_is_told_apart_from_the_place(hours):
    envmap = sunny(time=TIME + timedelta(hours=hours))
    place, clock = (of(envmap, name) for name in ("sun-place", "sun-clock"))
    assert place.verdict is Verdict.PASS
    assert clock.verdict is Verdict.FAIL
    assert clock.value == abs(hours)
    assert ("fast" if hours > 0 else "slow") in clock.note


def test_local_time_taken_for_utc_is_found_far_from_greenwich():
    place = {"latitude_deg": 35.7, "longitude_deg": 139.7}
    time = datetime(2024, 6, 10, 1, 0, tzinfo=UTC)
    direction = sun_direction(35.7, 139.7, time)
    clock = of(sunny(direction, time=time + timedelta(hours=9), **place), "sun-clock")
    # Then the recorded hour is of the evening, with the sun below the horizon or in the west.
    assert clock.verdict is not Verdict.PASS
    wrong = sunny(direction, time=time + timedelta(hours=2), **place)
    assert of(wrong, "sun-clock").value == 2


@pytest.mark.parametrize(
    ("more", "why"),
    [
        ({"frame": Frame.LEVEL}, "north"),
        ({"time": None}, "time is not known"),
        ({"latitude_deg": None}, "place is not known"),
        ({"precision": TimePrecision.MONTH}, "only the month"),
        ({"time": TIME + timedelta(hours=14)}, "too low"),
    ],
)
def test_it_abstains_where_nothing_is_known(more, why):
    place = of(sunny(**more), "sun-place")
    assert place.verdict is Verdict.NOT_APPLICABLE
    assert why in place.note


def test_it_abstains_where_there_is_no_sun():
    envmap = sunny()
    cloudy = envmap.with_changes(radiance=np.minimum(envmap.radiance, 1))
    place = of(cloudy, "sun-place")
    assert place.verdict is Verdict.NOT_APPLICABLE
    assert "no sun" in place.note


def test_a_month_bounds_where_the_sun_can_be():
    june = of(sunny(precision=TimePrecision.MONTH), "sun-date")
    assert june.verdict is Verdict.PASS
    assert "65° high" in june.note or "64° high" in june.note
    december = sunny(time=TIME.replace(month=12), precision=TimePrecision.MONTH)
    assert of(december, "sun-date").verdict is Verdict.FAIL
    assert of(sunny(precision=TimePrecision.YEAR), "sun-date").verdict is Verdict.PASS
    assert of(sunny(), "sun-date").value is None


def test_a_sun_in_the_north_of_europe_fails_for_any_month():
    envmap = sunny(sun_direction(*PLACE, TIME.replace(hour=11)), precision=TimePrecision.YEAR)
    turned = envmap.with_changes(radiance=np.roll(envmap.radiance, 256, axis=1))
    assert of(envmap, "sun-date").verdict is Verdict.PASS
    assert of(turned, "sun-date").verdict is Verdict.FAIL

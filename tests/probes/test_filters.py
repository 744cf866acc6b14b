"""Which probes a filter lets pass: category, place, time, license, kind, sun, tags."""

from datetime import UTC, datetime

import numpy as np
import pytest
from pydantic import ValidationError

from panokit.capture import Capture, TimePrecision, license_from_spdx
from panokit.envmap import EnvironmentMap
from panokit.frames import Frame
from panokit.probes import Library, ProbeFilter
from panokit.provenance import Provenance, Step
from tests.conftest import sun_radiance


def a_map(id, *, sun=False, stage="", spdx="CC0-1.0", **known):
    rng = np.random.default_rng(len(id))
    radiance = rng.uniform(0.2, 1, (32, 64, 3)).astype(np.float32)
    if sun:
        radiance = sun_radiance(64, 40, diameter_deg=6)
    capture = Capture(provider="test", id=id, license=license_from_spdx(spdx, "A"), **known)
    steps = (Step(stage=stage, version="1"),) if stage else ()
    return EnvironmentMap(
        radiance=radiance, frame=Frame.LEVEL, capture=capture, provenance=Provenance(steps)
    )


def at(*numbers):
    return {"time": datetime(*numbers, tzinfo=UTC), "time_precision": TimePrecision.SECOND}


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    with Library.create(tmp_path_factory.mktemp("filters") / "lib") as made:
        made.add(
            a_map("lyon", stage="expand", latitude_deg=45.76, longitude_deg=4.84, place="Lyon",
                  **at(2024, 5, 6, 23, 59, 59)),
            name="lyon", category="outdoor_night", tags=("Bridge", "river"),
        )  # fmt: skip
        made.add(
            a_map("suva", sun=True, latitude_deg=-18.14, longitude_deg=178.44,
                  **at(2024, 5, 7, 0, 0, 0)),
            name="suva", category="outdoor_sunny",
        )  # fmt: skip
        made.add(
            a_map("apia", latitude_deg=-13.83, longitude_deg=-171.77, spdx="nobody-knows",
                  details={"tags": ["Street"], "categories": ["urban"]}),
            name="apia", category="indoor_hall",
        )  # fmt: skip
        made.add(a_map("render", stage="synthetic"), name="render", tags=("a_b",))
        yield made


@pytest.mark.parametrize(
    ("wanted", "names"),
    [
        ({"category": "outdoor"}, "lyon suva"),
        ({"category": "OUTDOOR_night"}, "lyon"),
        ({"category": "outdoor%"}, ""),
        ({"kind": "lifted"}, "lyon"),
        ({"kind": "native"}, "apia suva"),
        ({"kind": "synthetic"}, "render"),
        ({"bbox": (0, 40, 10, 50)}, "lyon"),
        # Over the date line: Fiji and Samoa, not Lyon.
        ({"bbox": (170, -30, -160, 0)}, "apia suva"),
        ({"date_from": "2024-05-07"}, "suva"),
        ({"date_to": "2024-05-06"}, "lyon"),
        ({"date_from": "2024-05-06", "date_to": "2024-05-07"}, "lyon suva"),
        ({"date_to": "2024-05-05"}, ""),
        ({"provider": "Test"}, "apia lyon render suva"),
        ({"trainable": True}, "lyon render suva"),
        ({"derivable": False}, "apia"),
        ({"storable": False}, "apia"),
        ({"license": "cc0-1.0", "kind": "native"}, "suva"),
        ({"has_sun": True}, "suva"),
        ({"has_sun": False}, "apia lyon render"),
        ({"tags": ("bridge",)}, "lyon"),
        ({"tags": ("BRIDGE", "river")}, "lyon"),
        ({"tags": ("bridge", "street")}, ""),
        ({"tags": ("street", "urban")}, "apia"),
        # Whole words, and no pattern.
        ({"tags": ("bri",)}, ""),
        ({"tags": ("a_b",)}, "render"),
        ({"tags": ("r_ver",)}, ""),
        ({"plausibility_max": 0.0}, ""),
        ({"dynamic_range_min_stops": 6.0}, "suva"),
    ],
)
def test_each_filter(library, wanted, names):
    found = library.list(ProbeFilter.model_validate(wanted))
    assert [entry.name for entry in found] == names.split()


def test_what_is_wrong_with_a_filter_is_told():
    for wanted in (
        {"bbox": (0, 50, 10, 40)},
        {"bbox": (0, -91, 10, 40)},
        {"date_from": "2024-05-07", "date_to": "2024-05-06"},
        {"colour": "red"},
    ):
        with pytest.raises(ValidationError):
            ProbeFilter.model_validate(wanted)


def test_a_line_tells_all_that_filters_ask_for(library):
    lyon = library.list(ProbeFilter(name="lyon"))[0]
    value = lyon.to_json()
    assert value["tags"] == ["bridge", "river"]
    assert (value["time"], value["place"]) == ("2024-05-06T23:59:59Z", "Lyon")
    assert (lyon.has_sun, lyon.in_place, lyon.trainable) == (False, False, True)
    sunny = library.list(ProbeFilter(name="suva"))[0]
    assert sunny.sun_azimuth_deg == pytest.approx(17, abs=4)  # a pixel is 5.6 degrees
    assert sunny.sun_elevation_deg == pytest.approx(40, abs=4)


def test_a_picture_of_a_street_service_is_of_a_street(tmp_path, make_map):
    with Library.create(tmp_path) as library:
        assert library.add(make_map(1)).probe.category == "outdoor_street"
        assert library.add(make_map(2), category="park").probe.category == "park"
        assert library.add(a_map("unknown")).probe.category == ""


def test_the_moon_is_no_sun(tmp_path):
    with Library.create(tmp_path) as library:
        assert library.add(a_map("day", sun=True)).probe.sun is not None
        night = library.add(a_map("night", sun=True), category="outdoor_night")
        assert night.probe.sun is None


def test_the_sun_of_the_record_counts(tmp_path):
    said = {"azimuth_deg": 1.0, "elevation_deg": 2.0, "evidence": "ephemeris"}
    step = Step(stage="expand", version="1", values={"lighting": {"sun": said}})
    without = Step(stage="expand", version="1", values={"lighting": {"sun": None}})
    with Library.create(tmp_path) as library:
        for id, one, expected in (("a", step, said), ("b", without, None)):
            envmap = a_map(id, sun=True).with_changes(provenance=Provenance((one,)))
            probe = library.add(envmap).probe
            assert probe.sun == expected
            assert library.show(probe.id).sun == expected

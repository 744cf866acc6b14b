from datetime import UTC, datetime

import numpy as np
import pytest

from panokit.capture import (
    Capture,
    License,
    TileGrid,
    TimePrecision,
    license_from_spdx,
    local_capture,
    wrap_degrees,
)
from panokit.errors import RecordError, UsageError
from panokit.frames import azimuth_elevation_from_direction


def full_capture() -> Capture:
    return Capture(
        provider="google-tiles",
        id="jGaYvr31o-KsarHZtXbc5w",
        license=License(id="google-maps-platform", attribution="Google Maps"),
        latitude_deg=-33.88,
        longitude_deg=151.2,
        time=datetime(2023, 10, 1, tzinfo=UTC),
        time_precision=TimePrecision.MONTH,
        heading_deg=94.3,
        pitch_deg=-1.6,
        roll_deg=1.7,
        details={"links": [1, 2]},
    )


def test_json_round_trip():
    capture = full_capture()
    assert Capture.from_json(capture.to_json()) == capture
    assert capture.to_json()["time"] == "2023-10-01T00:00:00Z"


def test_empty_fields_stay_out_of_the_record():
    assert set(local_capture("a").to_json()) == {"provider", "id", "license"}


@pytest.mark.parametrize("damage", [{"license": None}, {"unknown": 1}, {"time": "yesterday"}])
def test_a_damaged_record_is_named(damage):
    with pytest.raises(RecordError, match="not a capture record"):
        Capture.from_json(full_capture().to_json() | damage)


def test_time_needs_a_zone_and_a_precision():
    with pytest.raises(UsageError, match="timezone"):
        local_capture("a", time=datetime(2020, 1, 1), time_precision=TimePrecision.DAY)
    with pytest.raises(UsageError, match="go together"):
        local_capture("a", time=datetime(2020, 1, 1, tzinfo=UTC))


def test_positions_off_the_earth_are_refused():
    with pytest.raises(UsageError, match="latitude_deg"):
        local_capture("a", latitude_deg=91.0)


def test_key_is_a_safe_file_name():
    capture = local_capture("../../etc/passwd?key=1")
    assert "/" not in capture.key
    assert not capture.key.startswith(".")


def test_pose_needs_a_heading():
    assert local_capture("a", pitch_deg=3.0).world_from_camera is None
    pose = full_capture().world_from_camera
    azimuth, elevation = azimuth_elevation_from_direction(pose.apply(np.array([0.0, 0, -1])))
    assert np.rad2deg([azimuth, elevation]) == pytest.approx([94.3, -1.6])


@pytest.mark.parametrize(
    ("angle", "wrapped"), [(354.47, -5.53), (180, 180), (-180, 180), (0, 0), (725, 5)]
)
def test_roll_is_wrapped(angle, wrapped):
    assert wrap_degrees(angle) == pytest.approx(wrapped)


def test_open_licenses_permit_and_unknown_ones_do_not():
    assert license_from_spdx("etalab-2.0", "x").train
    assert license_from_spdx("cc-by-sa-4.0", "x").share_alike
    unknown = license_from_spdx("proprietary", "x")
    assert not (unknown.store or unknown.derive or unknown.train)


@pytest.mark.parametrize(
    ("size", "cells"),
    [((16384, 8192), (32, 16)), ((13312, 6656), (26, 13)), ((3328, 1664), (7, 4))],
)
def test_tiles_cover_the_picture(size, cells):
    grid = TileGrid(width_px=size[0], height_px=size[1], tile_width_px=512, tile_height_px=512)
    assert (grid.columns, grid.rows) == cells
    assert len(grid.cells()) == cells[0] * cells[1]
    assert TileGrid.from_json(grid.to_json()) == grid

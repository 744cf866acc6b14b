"""Files of an estimate: a light is where it was, whoever reads them."""

import json
import re
from dataclasses import replace

import cv2
import numpy as np
import pytest

from panokit.errors import RecordError, StorageError
from panokit.frames import (
    TOOL_FROM_PANOKIT,
    Frame,
    Rotation,
    angle_between,
    azimuth_elevation_from_direction,
)
from panokit.io import read_environment_map, read_exr
from panokit.io.adapters import harmonics_from_json
from panokit.io.files import sha256_of_file
from panokit.lighting import Confidence, OutputSettings, read_outputs, write_outputs
from panokit.sphere import energy, light_vector, project_harmonics
from tests.lighting.fakes import beacon, estimate_of

SUN = np.array([0.5, 0.4, -0.6])
LEVEL = Rotation.from_heading_pitch_roll(0, -0.3, 0.1)
SMALL = OutputSettings(width_px=128, gaussians=4, exports=("blender", "usd", "mitsuba"))


def off_deg(one, other) -> float:
    return float(np.degrees(angle_between(np.asarray(one, float), np.asarray(other, float))))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A beacon, by a camera that looks down."""
    out = tmp_path_factory.mktemp("light")
    write_outputs(estimate_of(beacon(SUN), level=LEVEL, model="some-1"), out, SMALL)
    return out


def test_the_square_map_comes_back_to_the_last_bit(folder):
    radiance, record = read_outputs(folder)
    np.testing.assert_array_equal(radiance, beacon(SUN))
    assert record["model"] == "some-1"
    _, attributes = read_exr(folder / "light64.exr")
    assert attributes["projection"] == "equirectangular-anamorphic"
    assert attributes["frame"] == "camera"


def test_the_lat_long_maps_are_level_and_have_the_energy(folder):
    for name, rtol in (("light.exr", 1e-4), ("light.hdr", 4e-3)):
        envmap = read_environment_map(folder / name)
        assert envmap.frame is Frame.LEVEL
        np.testing.assert_allclose(energy(envmap.radiance), energy(beacon(SUN)), rtol=rtol)
        assert off_deg(light_vector(envmap.radiance - 0.2), LEVEL.apply(SUN)) < 4


def test_unless_the_frame_of_the_camera_is_asked_for(tmp_path):
    settings = SMALL.model_copy(update={"frame": "camera", "exports": ()})
    write_outputs(estimate_of(beacon(SUN), level=LEVEL), tmp_path, settings)
    envmap = read_environment_map(tmp_path / "light.exr")
    assert envmap.frame is Frame.CAMERA
    assert off_deg(light_vector(envmap.radiance - 0.2), SUN) < 4


def brightest(pixels):
    """Where in (0, 1) x (0, 1) of a picture its brightest pixel is."""
    row, column = np.unravel_index(int(pixels.sum(axis=-1).argmax()), pixels.shape[:2])
    return (column + 0.5) / pixels.shape[1], (row + 0.5) / pixels.shape[0]


def test_in_blender_the_beacon_lies_where_it_was(folder):
    script = (folder / "light.blender.py").read_text()
    pixels, _ = read_exr(folder / re.search(r"TEXTURE = '(.*)'", script).group(1))
    turn = np.radians(float(re.search(r"\(0, 0, radians\((.*)\)\)", script).group(1)))
    # An environment texture has +X at its center, +Y at a quarter from the left, +Z on top.
    u, v = brightest(pixels)
    azimuth, height = (0.5 - u) * 2 * np.pi, (0.5 - v) * np.pi
    looked_up = np.array([np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth),
                          np.sin(height)])  # fmt: skip
    # The node turned the scene's direction into this one.
    c, s = np.cos(-turn), np.sin(-turn)
    x, y, z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ looked_up
    assert off_deg([x, z, -y], LEVEL.apply(SUN)) < 4


def test_in_usd_the_beacon_lies_where_it_was(folder):
    stage = (folder / "light.usda").read_text()
    pixels, _ = read_exr(folder / re.search(r"@\./(.*)@", stage).group(1))
    half_turn = [float(v) for v in re.search(r"rotateXYZ = \((.*)\)", stage).group(1).split(",")]
    u, v = brightest(pixels)
    # The dome shows +Z at the center and +X to the left of it.
    azimuth, height = (0.5 - u) * 2 * np.pi, (0.5 - v) * np.pi
    on_dome = np.array([np.cos(height) * np.sin(azimuth), np.sin(height),
                        np.cos(height) * np.cos(azimuth)])  # fmt: skip
    turned = Rotation.about_axis((0, 1, 0), np.radians(half_turn[1])).apply(on_dome)
    assert half_turn[0] == half_turn[2] == 0
    assert off_deg(turned, LEVEL.apply(SUN)) < 4


def test_in_mitsuba_the_beacon_lies_where_it_was(folder):
    scene = (folder / "light.mitsuba.xml").read_text()
    pixels, _ = read_exr(folder / re.search(r'value="(.*\.exr)"', scene).group(1))
    assert '<rotate y="1" angle="180"/>' in scene
    u, v = brightest(pixels)
    seen = np.array([np.sin(v * np.pi) * np.sin((u - 0.5) * 2 * np.pi), np.cos(v * np.pi),
                     -np.sin(v * np.pi) * np.cos((u - 0.5) * 2 * np.pi)])  # fmt: skip
    mitsuba = TOOL_FROM_PANOKIT["mitsuba"]
    half = Rotation.about_axis((0, 1, 0), np.pi)
    assert off_deg(half.apply(mitsuba.apply(seen)), LEVEL.apply(SUN)) < 4


def test_harmonics_are_those_of_the_map(folder):
    envmap = read_environment_map(folder / "light.exr")
    for order in (2, 4):
        value = json.loads((folder / f"light.harmonics-{order}.json").read_text())
        found = harmonics_from_json(value)
        assert found.shape == ((order + 1) ** 2, 3)
        np.testing.assert_allclose(found, project_harmonics(envmap.radiance, order), rtol=1e-6)


def test_harmonics_of_a_constant_map_are_one_number(tmp_path):
    estimate = estimate_of(np.full((64, 64, 3), 0.7, np.float32), level=LEVEL)
    write_outputs(estimate, tmp_path, SMALL.model_copy(update={"exports": ()}))
    for order in (2, 4):
        value = json.loads((tmp_path / f"light.harmonics-{order}.json").read_text())
        found = harmonics_from_json(value)
        np.testing.assert_allclose(found[0], 0.7 * np.sqrt(4 * np.pi), rtol=1e-5)
        np.testing.assert_allclose(found[1:], 0, atol=1e-3)


def test_lights_are_in_the_frame_of_the_map(folder):
    lights = json.loads((folder / "light.lights.json").read_text())
    azimuth, elevation = azimuth_elevation_from_direction(LEVEL.apply(SUN))
    assert lights["frame"] == "level"
    assert lights["primary"]["azimuth_deg"] == pytest.approx(np.degrees(azimuth), abs=5)
    assert lights["primary"]["elevation_deg"] == pytest.approx(np.degrees(elevation), abs=3)


def test_the_primary_light_may_be_apart(tmp_path):
    settings = OutputSettings(width_px=128, exports=("blender", "usd"), sun="apart")
    record = write_outputs(estimate_of(beacon(SUN)), tmp_path, settings)
    whole = read_environment_map(tmp_path / "light.exr")
    rest = read_environment_map(tmp_path / "light-rest.exr")
    np.testing.assert_allclose(energy(whole.radiance), energy(beacon(SUN)), rtol=1e-4)
    sun = record["sun_apart"]
    together = energy(rest.radiance) + sun["irradiance_rgb"]
    np.testing.assert_allclose(together, energy(beacon(SUN)), rtol=1e-3)
    assert off_deg(sun["direction"], SUN) < 4
    assert "DistantLight" in (tmp_path / "light-rest.usda").read_text()


def test_an_even_light_has_nothing_to_put_apart(tmp_path):
    settings = OutputSettings(width_px=64, exports=("usd",), sun="apart")
    even = estimate_of(np.ones((64, 64, 3), np.float32))
    record = write_outputs(even, tmp_path, settings)
    assert record["sun_apart"] is None
    assert record["tools"]["usd"][0] == "light.usda"


def test_the_confidence_is_a_picture_over_the_map(tmp_path):
    error = np.zeros((64, 64), np.float32)
    error[20:24, 40:44] = np.log(2)
    confidence = Confidence(error=error, direction_deg=3, calibrated=False)
    estimate = estimate_of(beacon(SUN))
    settings = SMALL.model_copy(update={"exports": ()})
    record = write_outputs(replace(estimate, confidence=confidence), tmp_path, settings)
    picture = cv2.imread(str(tmp_path / "confidence.png"), cv2.IMREAD_UNCHANGED)
    assert picture.shape == (128, 256)
    assert picture[0, 0] == 255
    assert abs(int(picture[43, 167]) - 128) < 3
    assert record["confidence"]["calibrated"] is False
    assert 0.9 < record["confidence"]["value"] < 1


def test_without_confidence_there_is_no_picture(tmp_path):
    settings = SMALL.model_copy(update={"exports": ()})
    record = write_outputs(estimate_of(beacon(SUN), error=None), tmp_path, settings)
    assert record["confidence"] is None
    assert not (tmp_path / "confidence.png").exists()


def test_the_record_lists_every_file_and_comes_last(folder, tmp_path, monkeypatch):
    _, record = read_outputs(folder)
    there = {path.name for path in folder.iterdir()} - {"estimate.json"}
    assert set(record["files"]) == there
    for name, entry in record["files"].items():
        assert sha256_of_file(folder / name) == entry["sha256"]
    write_outputs(estimate_of(beacon(SUN)), tmp_path, SMALL)

    def full_disk(*_):
        raise OSError("full")

    monkeypatch.setattr("panokit.lighting.outputs.write_radiance", full_disk)
    with pytest.raises(OSError, match="full"):
        write_outputs(estimate_of(beacon(-SUN)), tmp_path, SMALL)
    with pytest.raises(RecordError):
        read_outputs(tmp_path)


def test_the_same_estimate_makes_the_same_files(folder, tmp_path):
    write_outputs(estimate_of(beacon(SUN), level=LEVEL, model="some-1"), tmp_path, SMALL)
    for path in folder.iterdir():
        assert (tmp_path / path.name).read_bytes() == path.read_bytes(), path.name


def test_a_file_in_place_of_the_folder_is_told(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(StorageError, match="taken"):
        write_outputs(estimate_of(beacon(SUN)), tmp_path / "taken", SMALL)

"""Exports of the library: every target, its beacon, its credits, and what goes wrong."""

import csv
import json
import re
from dataclasses import replace

import cv2
import numpy as np
import OpenEXR
import pyarrow.parquet as pq
import pytest

from panokit.capture import license_from_spdx
from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.frames import Frame, direction_from_azimuth_elevation
from panokit.io import read_environment_map, write_exr
from panokit.probes import ExportSettings, Library, export_probes
from panokit.sphere import energy, evaluate_harmonics
from tests.conftest import sun_radiance
from tests.io.adapters.conftest import BRIGHT, HEIGHT, direction_of

TEXEL = (9, 50)
# What only a file with a light of its own has in it.
SUN_MARKS = {
    "usd": "DistantLight", "blender": "'irradiance'", "mitsuba": "directional",
    "gltf": "KHR_lights_punctual", "harmonics": '"angular_radius_deg"', "exr": "",
}  # fmt: skip


@pytest.fixture
def library(tmp_path, capture):
    with Library.create(tmp_path / "lib") as made:
        radiance = np.full((HEIGHT, 2 * HEIGHT, 3), 1.0, np.float32)
        radiance[TEXEL] = BRIGHT
        made.add(
            EnvironmentMap(radiance=radiance, frame=Frame.WORLD, capture=capture), name="a beacon"
        )
        sunny = EnvironmentMap(
            radiance=sun_radiance(256, 40, azimuth_deg=60, diameter_deg=4), frame=Frame.LEVEL
        )
        made.add(sunny, name="sunny")
        yield made


def run(library, name, to, out, **settings):
    result = export_probes(library, [name], out, ExportSettings(to=to, **settings))
    assert not result.rejections
    return result.exported[0].files


def texel_by_openexr(direction, width, height):
    """ImfEnvmap.h, with pixel edges on the borders: +Z at the center, longitude to the left."""
    x, y, z = -direction[0], direction[1], -direction[2]  # panokit's direction in those axes
    column = (np.pi - np.arctan2(x, z)) / (2 * np.pi) * width
    return int((np.pi / 2 - np.arcsin(y)) / np.pi * height), int(column) % width


@pytest.mark.parametrize("half", [False, True])
def test_exr(library, tmp_path, half):
    files = run(library, "a beacon", "exr", tmp_path, half=half)
    assert files == ("a_beacon.exr", "a_beacon.json")
    with OpenEXR.File(str(tmp_path / files[0])) as file:
        pixels = file.channels()["RGB"].pixels
        assert file.header()["envmap"] == OpenEXR.ENVMAP_LATLONG
        assert pixels.dtype == (np.float16 if half else np.float32)
    place = texel_by_openexr(direction_of(*TEXEL), 2 * HEIGHT, HEIGHT)
    np.testing.assert_allclose(pixels[place].astype(float), BRIGHT, rtol=1e-3)
    assert read_environment_map(tmp_path / files[0]).capture.id == "a1b2"


def test_hdr(library, tmp_path):
    (file, _) = run(library, "a beacon", "hdr", tmp_path)
    # Decoded by OpenCV, not by panokit.
    pixels = cv2.imread(str(tmp_path / file), cv2.IMREAD_UNCHANGED)[..., ::-1]
    place = texel_by_openexr(direction_of(*TEXEL), 2 * HEIGHT, HEIGHT)
    np.testing.assert_allclose(pixels[place], BRIGHT, rtol=0.01)


def test_usd_blender_and_mitsuba_name_their_texture_and_it_is_there(library, tmp_path):
    for to, pattern in (
        ("usd", r"@\./(.*)@"), ("blender", r"TEXTURE = '(.*)'"), ("mitsuba", r'value="(.*\.exr)"'),
    ):  # fmt: skip
        first, *_ = run(library, "a beacon", to, tmp_path / to)
        texture = re.search(pattern, (tmp_path / to / first).read_text())[1]
        assert (tmp_path / to / texture).is_file()


def test_mitsubas_texture_has_rows_on_the_poles(library, tmp_path):
    _, texture = run(library, "a beacon", "mitsuba", tmp_path)
    with OpenEXR.File(str(tmp_path / texture)) as file:
        pixels = file.channels()["RGB"].pixels
        assert "lie on the zenith" in file.header()["comments"]
    row = np.argmax(pixels[..., 0].max(axis=1))
    # Mitsuba's row i lies at i / (H - 1) from pole to pole.
    assert abs(row / (HEIGHT - 1) - (TEXEL[0] + 0.5) / HEIGHT) < 1 / HEIGHT


def test_gltf_is_a_glb(library, tmp_path):
    (file,) = run(library, "a beacon", "gltf", tmp_path, face_px=32)
    assert (tmp_path / file).read_bytes()[:4] == b"glTF"


def test_harmonics_point_at_the_beacon(library, tmp_path):
    (file,) = run(library, "a beacon", "harmonics", tmp_path, harmonics_order=6)
    value = json.loads((tmp_path / file).read_text())
    rows = np.array(value["radiance_rgb"])
    assert rows.shape == (49, 3)
    around = np.array([direction_of(r, c) for r in range(HEIGHT) for c in range(2 * HEIGHT)])
    found = around[np.argmax(evaluate_harmonics(rows, around)[:, 0])]
    assert found @ direction_of(*TEXEL) > np.cos(np.deg2rad(6))


@pytest.mark.parametrize("to", ["exr", "usd", "blender", "mitsuba", "gltf", "harmonics"])
def test_a_sun_apart_is_in_the_file_and_out_of_the_map(library, tmp_path, to):
    result = export_probes(library, ["sunny"], tmp_path, ExportSettings(to=to, sun="apart"))
    (one,) = result.exported
    toward = direction_from_azimuth_elevation(np.deg2rad(60), np.deg2rad(40))
    assert one.sun.direction @ toward > np.cos(np.deg2rad(1))
    whole = energy(library.read("sunny").radiance)
    if to in ("exr", "usd", "blender"):
        rest = read_environment_map(next(tmp_path.glob("sunny.exr")))
        np.testing.assert_allclose(energy(rest.radiance) + one.sun.irradiance, whole, rtol=1e-4)
        assert rest.provenance.steps[-1].stage == "export"
    told = (tmp_path / one.files[0]).read_bytes().decode("latin1")
    assert SUN_MARKS[to] in told
    listed = json.loads((tmp_path / f"export-{to}.json").read_text())
    assert listed["probes"][0]["sun"]["irradiance_rgb"][0] > 0


def test_by_default_the_sun_stays_in_the_map(library, tmp_path):
    stage, *_ = run(library, "sunny", "usd", tmp_path)
    assert "DistantLight" not in (tmp_path / stage).read_text()
    whole = library.read("sunny").radiance
    np.testing.assert_array_equal(read_environment_map(tmp_path / "sunny.exr").radiance, whole)


def test_a_smaller_map_has_the_same_energy(library, tmp_path):
    run(library, "sunny", "exr", tmp_path, width_px=64)
    small = read_environment_map(tmp_path / "sunny.exr")
    assert small.width_px == 64
    np.testing.assert_allclose(
        energy(small.radiance), energy(library.read("sunny").radiance), rtol=1e-4
    )


def test_credits_go_with_every_export_and_add_up(library, tmp_path):
    run(library, "a beacon", "harmonics", tmp_path)
    run(library, "sunny", "usd", tmp_path)
    sheet = (tmp_path / "ATTRIBUTION.md").read_text()
    assert "CC-BY-SA-4.0" in sheet
    assert "Somebody" in sheet
    rows = list(csv.DictReader((tmp_path / "ATTRIBUTION.csv").read_text().splitlines()))
    assert {row["id"] for row in rows} == {"a1b2", "sunny"}
    assert {row["license"] for row in rows} == {"CC-BY-SA-4.0", "unknown"}


def test_an_export_again_is_the_same_byte_for_byte(library, tmp_path):
    for to in ("usd", "gltf", "harmonics"):
        for folder in ("one", "two"):
            export_probes(library, ["sunny", "a beacon"], tmp_path / folder, ExportSettings(to=to))
        export_probes(library, ["sunny"], tmp_path / "two", ExportSettings(to=to))
    contents = [
        {p.name: p.read_bytes() for p in (tmp_path / folder).iterdir()} for folder in ("one", "two")
    ]
    assert contents[0] == contents[1]
    assert len(contents[0]) > 8


def test_names_that_would_collide_do_not(library, tmp_path, capture):
    other = replace(capture, id="other", license=license_from_spdx("CC0-1.0", ""))
    flat = EnvironmentMap(radiance=np.ones((16, 32, 3), np.float32), capture=other)
    id = library.add(flat, name="A/beacon").probe.id
    result = export_probes(
        library, ["a beacon", id], tmp_path, ExportSettings(to="harmonics", harmonics_order=1)
    )
    names = [one.files[0] for one in result.exported]
    assert names == ["a_beacon.harmonics.json", f"A_beacon-{id[:8]}.harmonics.json"]


def test_a_changed_map_is_rejected_and_the_others_go_on(library, tmp_path):
    path = library.map_path("sunny")
    write_exr(path, np.ones((8, 16, 3), np.float32))
    done = []
    result = export_probes(
        library, ["sunny", "a beacon"], tmp_path, ExportSettings(to="exr"), on_done=done.append
    )
    assert [one.reason for one in result.rejections] == ["changed-on-disk"]
    assert "Restore it" in result.rejections[0].message
    assert [one.probe.name for one in result.exported] == ["a beacon"]
    assert len(done) == 2


def test_the_table_has_a_row_for_each_probe(library, tmp_path):
    result = export_probes(library, ["a beacon", "sunny"], tmp_path, ExportSettings(to="parquet"))
    table = pq.read_table(result.table).to_pylist()
    assert [row["name"] for row in table] == ["a beacon", "sunny"]
    first, second = table
    assert (first["license"], first["trainable"], first["has_sun"]) == ("CC-BY-SA-4.0", True, False)
    assert (first["latitude_deg"], second["latitude_deg"]) == (48.5, None)
    assert second["has_sun"] is True
    assert len(second["descriptor"]) == 13
    assert second["map"] == str(library.map_path("sunny"))
    assert (tmp_path / "ATTRIBUTION.md").exists()


def test_wrong_calls(library, tmp_path):
    with pytest.raises(UsageError, match="no probe to export"):
        export_probes(library, [], tmp_path, ExportSettings(to="exr"))
    with pytest.raises(UsageError, match="Did you mean"):
        export_probes(library, ["suny"], tmp_path, ExportSettings(to="exr"))
    with pytest.raises(ValueError, match="power of two"):
        ExportSettings(to="gltf", face_px=100)
    too_fine = export_probes(
        library, ["a beacon"], tmp_path, ExportSettings(to="harmonics", harmonics_order=20)
    )
    assert [one.reason for one in too_fine.rejections] == ["too-small"]

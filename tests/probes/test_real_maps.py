"""Captured HDRIs, used in place: what is found out about them, a choice of them, their exports."""

import json
import os
import struct
from pathlib import Path

import numpy as np
import pytest

from panokit.console import Console
from panokit.io import read_environment_map
from panokit.pipeline.adding import add_maps
from panokit.probes import (
    AddSettings,
    ExportSettings,
    Library,
    ProbeFilter,
    SelectSettings,
    export_probes,
    select,
)
from panokit.sphere import energy

pytestmark = pytest.mark.data

NAMES = ("adams_place_bridge", "aircraft_workshop_01", "aristea_wreck", "autumn_field_puresky",
         "blaubeuren_night", "brown_photostudio_01", "brown_photostudio_02", "chinese_garden",
         "hilly_terrain_01", "kloppenheim_02")  # fmt: skip


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    probes = Path(os.environ["PANOKIT_DATA"]) / "probes"
    folder = tmp_path_factory.mktemp("real")
    maps = [next(probes.glob(f"{name}_1k.*")) for name in NAMES]
    add_maps(maps, folder / "lib", AddSettings(in_place=True), Console(quiet=True))
    with Library.open(folder / "lib") as made:
        yield made


def test_suns_are_found_and_the_moon_is_none(library):
    sunny = {entry.name for entry in library.list(ProbeFilter(has_sun=True))}
    assert sunny == {"autumn_field_puresky", "chinese_garden", "hilly_terrain_01"}
    nights = library.list(ProbeFilter(category="outdoor_night"))
    assert {entry.name for entry in nights} == {"blaubeuren_night", "kloppenheim_02"}


def test_a_choice_has_one_of_each_category_and_is_spread_out(library):
    wanted = SelectSettings(count=6)
    chosen = select(library.list(), library.descriptors(), wanted)
    categories = [entry.category for entry in library.entries(chosen.ids)]
    assert len(set(categories)) == 6
    # Different rooms, skies and nights are farther apart than what is common.
    assert chosen.least_distance > 1


def test_a_sun_of_a_hundred_thousand_survives_eight_bits(library, tmp_path):
    name = "autumn_field_puresky"
    radiance = library.read(name).radiance
    assert radiance.max() > 1e5
    result = export_probes(library, [name], tmp_path, ExportSettings(to="gltf", face_px=64))
    data = (tmp_path / result.exported[0].files[0]).read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    value = json.loads(data[20 : 20 + size])
    lights = value["extensions"]["KHR_lights_punctual"]["lights"]
    apart = sum(light["intensity"] * np.array(light["color"]) for light in lights)
    ibl = value["extensions"]["EXT_lights_image_based"]["lights"][0]
    rest = np.array(ibl["irradianceCoefficients"][0]) * ibl["intensity"] / (np.pi * 0.2820948)
    np.testing.assert_allclose(rest + apart, energy(radiance), rtol=1e-3)
    assert apart[0] > 0.3 * energy(radiance)[0]


def test_the_sun_apart_and_the_rest_are_the_map(library, tmp_path):
    settings = ExportSettings(to="usd", sun="apart", half=True)
    result = export_probes(library, ["hilly_terrain_01", "aristea_wreck"], tmp_path, settings)
    sunny, overcast = result.exported
    assert overcast.sun is None
    rest = energy(read_environment_map(tmp_path / "hilly_terrain_01.exr").radiance)
    whole = energy(library.read("hilly_terrain_01").radiance)
    np.testing.assert_allclose(rest + sunny.sun.irradiance, whole, rtol=1e-4)

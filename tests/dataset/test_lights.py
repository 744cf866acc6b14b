"""The light of a dataset: where it is from, what is one place, what may be trained with."""

import numpy as np
import pytest

from panokit.capture import Capture, License, license_from_spdx
from panokit.dataset.lights import open_lights
from panokit.envmap import EnvironmentMap
from panokit.errors import LicenseError, UsageError
from panokit.io import write_environment_map
from panokit.probes import Library
from panokit.probes.selection import Selection, write_selection
from panokit.provenance import Provenance, Step
from panokit.sphere import energy

CC0 = license_from_spdx("CC0-1.0", "Somebody")


def put(folder, name, *, capture=None, provenance=None, seed=0, width_px=32):
    rng = np.random.default_rng(seed)
    radiance = rng.uniform(0, 2, (width_px // 2, width_px, 3)).astype(np.float32)
    folder.mkdir(exist_ok=True)
    envmap = EnvironmentMap(
        radiance=radiance, capture=capture, provenance=provenance or Provenance()
    )
    write_environment_map(envmap, folder / f"{name}.exr")
    return envmap


def capture_at(id, latitude=None, longitude=None, **known):
    return Capture(
        provider="panoramax", id=id, license=CC0, latitude_deg=latitude, longitude_deg=longitude,
        **known,
    )  # fmt: skip


def test_maps_of_neighbors_are_one_place(tmp_path):
    put(tmp_path / "maps", "a", capture=capture_at("a", 51.0, 0.0), seed=1)
    put(tmp_path / "maps", "b", capture=capture_at("b", 51.001, 0.0), seed=2)
    put(tmp_path / "maps", "c", capture=capture_at("c", 51.1, 0.0), seed=3)
    lights = open_lights([tmp_path / "maps"]).all
    assert lights["a"].place == lights["b"].place != lights["c"].place


def test_equal_files_are_one_place_whatever_they_are_called(tmp_path):
    put(tmp_path / "maps", "a", capture=capture_at("a", place="Bath"), seed=1)
    put(tmp_path / "maps", "b", capture=capture_at("b", place="Ely"), seed=2)
    data = (tmp_path / "maps" / "a.exr").read_bytes()
    (tmp_path / "maps" / "c.exr").write_bytes(data)
    with pytest.raises(LicenseError):  # a file without a record has no license
        open_lights([tmp_path / "maps"])
    lights = open_lights([tmp_path / "maps"], own_right="mine").all
    assert lights["a"].place == lights["c"].place != lights["b"].place


def test_the_kind_of_light_is_read_from_its_history(tmp_path):
    step = Step(stage="expand", version="1", settings_digest="", input_digests=())
    put(tmp_path / "maps", "native", capture=capture_at("n"), seed=1)
    put(tmp_path / "maps", "lifted", capture=capture_at("l"), provenance=Provenance((step,)))
    city = Capture(provider="synthetic", id="s", license=CC0)
    put(tmp_path / "maps", "synthetic", capture=city, seed=3)
    found = {id: light.kind for id, light in open_lights([tmp_path / "maps"]).all.items()}
    assert found == {"native": "native", "lifted": "lifted", "synthetic": "synthetic"}


def test_a_library_gives_its_probes(tmp_path):
    envmap = put(tmp_path / "maps", "a", capture=capture_at("a", place="Bath"))
    with Library.create(tmp_path / "library") as library:
        added = library.add(tmp_path / "maps" / "a.exr")
    lights = open_lights([tmp_path / "library"])
    assert list(lights.all) == [added.probe.id]
    np.testing.assert_allclose(
        energy(lights.load(added.probe.id).radiance), energy(envmap.radiance), rtol=1e-5
    )


def test_a_selection_takes_some_of_a_library(tmp_path):
    with Library.create(tmp_path / "library") as library:
        ids = []
        for number in range(3):
            put(tmp_path / "maps", f"m{number}", capture=capture_at(f"m{number}"), seed=number)
            ids.append(library.add(tmp_path / "maps" / f"m{number}.exr").probe.id)
    write_selection(Selection(ids=(ids[2], ids[0]), names=("c", "a")), tmp_path / "chosen.json")
    lights = open_lights([tmp_path / "library"], selection=tmp_path / "chosen.json")
    assert set(lights.all) == {ids[0], ids[2]}
    write_selection(Selection(ids=("nobody",), names=("x",)), tmp_path / "other.json")
    with pytest.raises(UsageError, match="nobody"):
        open_lights([tmp_path / "library"], selection=tmp_path / "other.json")


def test_a_manifest_tells_places_and_leaves_out_what_is_not_for_training(tmp_path):
    for number, name in enumerate(("a", "b", "c")):
        put(tmp_path / "maps", name, seed=number)
    rows = [
        "name,file,licence,split_group,usable_for,category",
        "a,a.exr,CC0-1.0,yard,training,outdoor_sunny+urban",
        "b,b.exr,CC0-1.0,yard,training,outdoor_sunny",
        "c,c.exr,CC0-1.0,hall,robustness only,indoor",
    ]
    (tmp_path / "maps" / "manifest.csv").write_text("\n".join(rows))
    lights = open_lights([tmp_path / "maps"]).all
    assert set(lights) == {"a", "b"}
    assert lights["a"].place == lights["b"].place == "yard"
    assert lights["a"].category == "outdoor_sunny"


def test_what_may_not_be_trained_with_is_refused_by_name(tmp_path):
    terms = License(id="google-maps-platform", attribution="Google", store=True)
    put(tmp_path / "maps", "a", capture=Capture(provider="google-tiles", id="x", license=terms))
    with pytest.raises(LicenseError, match="google-maps-platform"):
        open_lights([tmp_path / "maps"])
    assert open_lights([tmp_path / "maps"], own_right="agreement of 2026").all


def test_no_light_is_refused_with_the_way_out(tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(UsageError, match="probes add"):
        open_lights([tmp_path / "empty"])
    with pytest.raises(UsageError, match="no folder"):
        open_lights([tmp_path / "nothing"])


def test_maps_are_kept_at_their_working_size(tmp_path):
    envmap = put(tmp_path / "maps", "a", capture=capture_at("a"), width_px=1024)
    lights = open_lights([tmp_path / "maps"], packed=tmp_path / "packed")
    first = lights.load("a").radiance
    assert first.shape == (256, 512, 3)
    np.testing.assert_allclose(energy(first), energy(envmap.radiance), rtol=1e-4)
    again = open_lights([tmp_path / "maps"], packed=tmp_path / "packed")
    (tmp_path / "maps" / "a.exr").unlink()
    np.testing.assert_array_equal(again.load("a").radiance, first)

"""Adding maps: from folders with and without a manifest, as copies and in place."""

import pytest

from panokit.console import Console
from panokit.envmap import EnvironmentMap
from panokit.errors import RecordError, UsageError
from panokit.io import write_environment_map
from panokit.pipeline.adding import add_maps
from panokit.probes import AddSettings, Library
from tests.conftest import sun_radiance

QUIET = Console(quiet=True)


@pytest.fixture
def hdris(tmp_path):
    folder = tmp_path / "hdris"
    for name, elevation in (("low", 12), ("high", 55)):
        radiance = sun_radiance(64, elevation, diameter_deg=6)
        write_environment_map(EnvironmentMap(radiance=radiance), folder / f"{name}.exr")
        (folder / f"{name}.json").unlink()  # as others leave them
    return folder


def add(paths, folder, **settings):
    return add_maps(paths, folder, AddSettings(**settings), QUIET)


def test_a_folder_in_place_with_its_manifest(tmp_path, hdris):
    (hdris / "manifest.csv").write_text(
        "file,name,category,license,attribution,split_group\n"
        "low.exr,low_sun,outdoor_sunny+urban,CC0-1.0,Ada,harbor\n"
    )
    result = add([hdris], tmp_path / "lib", in_place=True, category="", license="CC-BY-4.0",
                 attribution="Grace", tags=("mine",))  # fmt: skip
    assert (len(result.added), result.rejections) == (2, ())
    with Library.open(tmp_path / "lib") as library:
        low, high = (library.show(name) for name in ("low_sun", "high"))
    assert (low.category, low.tags, low.capture.place) == (
        "outdoor_sunny", ("mine", "urban"), "harbor",
    )  # fmt: skip
    assert (low.license.id, low.license.attribution) == ("CC0-1.0", "Ada")
    assert (high.license.id, high.license.attribution) == ("CC-BY-4.0", "Grace")
    assert (low.kind, low.source is not None, high.source is not None) == ("native", True, True)
    assert not list((tmp_path / "lib").rglob("probe.exr"))


def test_a_map_with_a_record_keeps_what_it_says(tmp_path, sunny, capture):
    path = tmp_path / "a.exr"
    write_environment_map(sunny.with_changes(capture=capture), path)
    add([path], tmp_path / "lib", license="CC0-1.0", place="nowhere", category="street")
    with Library.open(tmp_path / "lib") as library:
        probe = library.show("a")
    assert probe.capture == capture
    assert probe.category == "street"


def test_a_map_of_which_nothing_is_known_has_no_capture(tmp_path, hdris):
    add([hdris / "low.exr"], tmp_path / "lib", kind="synthetic")
    with Library.open(tmp_path / "lib") as library:
        probe = library.show("low")
    assert probe.capture is None
    assert (probe.license.id, probe.kind) == ("unknown", "synthetic")


def test_a_broken_map_is_rejected_and_the_rest_goes_on(tmp_path, hdris):
    (hdris / "broken.exr").write_bytes(b"no map")
    result = add([hdris], tmp_path / "lib", in_place=True)
    assert [one.item for one in result.rejections] == ["broken"]
    assert len(result.added) == 2


def test_repair_makes_a_copy_and_not_in_place(tmp_path):
    with pytest.raises(ValueError, match="add a copy"):
        AddSettings(in_place=True, repair=True)


def test_what_is_not_there_is_told(tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(UsageError, match=r"no \.exr or \.hdr"):
        add([tmp_path / "empty"], tmp_path / "lib")
    assert not (tmp_path / "lib").exists()


def test_a_damaged_manifest_stops_before_anything_is_added(tmp_path, hdris):
    (hdris / "manifest.csv").write_text("name\nx\n")
    with pytest.raises(RecordError, match="line 2"):
        add([hdris], tmp_path / "lib")
    assert not (tmp_path / "lib").exists()


def test_maps_of_a_run_come_with_their_captures(tmp_path, sunny, capture):
    run = tmp_path / "run"
    write_environment_map(sunny.with_changes(capture=capture), run / "probes" / "a.exr")
    (run / "run.json").write_text("{}")
    result = add([run], tmp_path / "lib")
    assert result.added[0].probe.capture == capture

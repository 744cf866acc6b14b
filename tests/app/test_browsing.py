"""The probe library without a browser: filters, one probe in words, selections, exports."""

import zipfile

import numpy as np
import pytest

from panokit.app import browsing
from panokit.envmap import EnvironmentMap
from panokit.errors import SettingsError, UsageError
from panokit.probes import Library
from panokit.probes.settings import ExportSettings, ProbeFilter, SelectSettings


def light(seed):
    rng = np.random.default_rng(seed)
    radiance = rng.uniform(0.1, 0.5, (32, 64, 3)).astype(np.float32)
    radiance[4 + seed, 10 * seed % 64] = 50
    return EnvironmentMap(radiance=radiance)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    folder = tmp_path_factory.mktemp("library")
    with Library.create(folder) as shelves:
        for seed, (name, category) in enumerate(
            [("quay", "outdoor_sunny"), ("hall", "indoor"), ("wood", "outdoor_cloudy")]
        ):
            shelves.add(light(seed), name=name, category=category, tags=("dawn",) if seed else ())
    return folder


def names(found):
    return [entry.name for entry in found[0]]


def test_a_form_becomes_the_filter_of_the_command_line():
    typed = {
        "name": " quay ", "category": "", "has_sun": "no", "tags": "dawn, fog",
        "bbox": "7, 48, 8, 49", "date_from": "2024-05-06", "dynamic_range_min_stops": "9.5",
    }  # fmt: skip
    assert browsing.filter_of(typed) == ProbeFilter(
        name="quay", has_sun=False, tags=("dawn", "fog"), bbox=(7, 48, 8, 49),
        date_from="2024-05-06", dynamic_range_min_stops=9.5,
    )  # fmt: skip
    assert browsing.filter_of({}) == ProbeFilter()


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ({"dynamic_range_min_stops": "many"}, "dynamic range min stops"),
        ({"date_from": "yesterday"}, "date from"),
        ({"bbox": "1, 2"}, "bbox"),
        ({"date_from": "2024-05-06", "date_to": "2023-01-01"}, "after"),
    ],
)
def test_what_cannot_be_understood_is_told(typed, said):
    with pytest.raises(SettingsError, match=said):
        browsing.filter_of(typed)


def test_filters_narrow_the_gallery(library):
    assert names(browsing.find(library, {})) == ["hall", "quay", "wood"]
    assert names(browsing.find(library, {"category": "outdoor"})) == ["quay", "wood"]
    assert browsing.find(library, {"tags": "dawn", "name": "oo"})[1] == 3
    assert names(browsing.find(library, {"tags": "dawn", "name": "oo"})) == ["wood"]
    assert browsing.options_of(library)["category"] == ["indoor", "outdoor_cloudy", "outdoor_sunny"]


def test_no_library_is_told(tmp_path):
    with pytest.raises(UsageError, match="no probe library"):
        browsing.find(tmp_path / "none", {})


def test_previews_are_of_probes_alone(library):
    entry = browsing.find(library, {})[0][0]
    assert browsing.preview(library, entry.id).startswith(b"\xff\xd8")
    (library / "preview.jpg").write_bytes(b"secret")
    for wrong in ("..", "../probes", ".", "0" * 16, "a/b"):
        with pytest.raises(UsageError):
            browsing.preview(library, wrong)


def test_a_probe_is_told_in_words(library):
    id = browsing.find(library, {"name": "quay"})[0][0].id
    probe = browsing.probe_of(library, id)
    facts = dict(browsing.probe_facts(probe))
    assert facts["Category"] == "outdoor sunny"
    assert facts["Size"] == "64 × 32 px"
    assert dict(browsing.license_facts(probe))["License"] == "not known"
    checks = browsing.check_rows(probe)
    assert len(checks) == len(probe.report.checks)
    assert {row[3] for row in checks} <= {"pass", "fail", ""}
    assert b"u_world_from_view" in browsing.probe_page(library, id)


def test_a_selection_is_that_of_the_command_line(library):
    ids = browsing.choose(library, {"category": "outdoor"}, SelectSettings(count=5))
    assert sorted(ids) == sorted(e.id for e in browsing.find(library, {"category": "outdoor"})[0])
    with pytest.raises(UsageError):
        browsing.choose(library, {"name": "nothing"}, SelectSettings(count=1))


def test_an_export_is_one_archive_with_the_credits(library, tmp_path):
    ids = [entry.id for entry in browsing.find(library, {})[0]]
    done = []
    content, media_type, name, problems = browsing.export(
        library, ids, ExportSettings(to="blender"), tmp_path / "out", lambda: done.append(1)
    )
    assert (media_type, name, problems, len(done)) == (
        "application/zip",
        "probes-blender.zip",
        (),
        3,
    )
    inside = zipfile.ZipFile(content).namelist()
    assert "ATTRIBUTION.md" in inside
    assert "quay.exr" in inside
    assert "quay.blender.py" in inside

from pathlib import Path

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.errors import RecordError, UsageError
from panokit.evaluate.probe_set import UNSORTED, assign_folds, find_probes, read_probes
from panokit.io import write_environment_map
from panokit.io.files import sha256_of_file


def test_a_manifest_tells_kinds_and_places(probe_folder: Path):
    probes = find_probes(probe_folder)
    assert [probe.name for probe in probes] == [f"map{i}" for i in range(8)]
    assert {probe.category for probe in probes} == {"indoor", "outdoor"}
    assert np.bincount(assign_folds(probes, 2)).tolist() == [4, 4]


def test_without_one_every_map_stands_for_itself(tmp_path: Path):
    envmap = EnvironmentMap(radiance=np.ones((8, 16, 3), np.float32))
    for name in ("b.exr", "a.hdr"):
        write_environment_map(envmap, tmp_path / name)
    (tmp_path / "readme.txt").write_text("no map", encoding="utf-8")
    probes = find_probes(tmp_path)
    assert [probe.name for probe in probes] == ["a", "b"]
    assert {probe.category for probe in probes} == {UNSORTED}
    assert probes[0].group != probes[1].group
    assert len(probes[0].sha256) == 64


def test_a_manifest_may_leave_out_what_it_does_not_know(tmp_path: Path):
    envmap = EnvironmentMap(radiance=np.ones((8, 16, 3), np.float32))
    for name in ("b.exr", "a.exr", "bad.exr"):
        write_environment_map(envmap, tmp_path / name)
    (tmp_path / "manifest.csv").write_text(
        "file,category,usable_for\nb.exr,street+urban,\na.exr,,training\nbad.exr,,robustness\n"
    )
    probes = find_probes(tmp_path)
    assert [(one.name, one.category, one.group) for one in probes] == [
        ("a", UNSORTED, "a"), ("b", "street", "b"),
    ]  # fmt: skip
    # By its digest a probe is known as seen: there always is one.
    assert probes[0].sha256 == sha256_of_file(tmp_path / "a.exr")
    assert [one.name for one in read_probes(tmp_path, "robustness")] == ["bad"]


def test_a_manifest_without_usable_probes_is_refused(tmp_path: Path):
    (tmp_path / "manifest.csv").write_text("file,usable_for\na.exr,robustness\n")
    with pytest.raises(RecordError, match="lists no probe for training"):
        read_probes(tmp_path)
    (tmp_path / "manifest.csv").write_text("name\na\n")
    with pytest.raises(RecordError, match="line 2: there is no `file`"):
        read_probes(tmp_path)


def test_a_folder_without_maps_is_refused(tmp_path: Path):
    with pytest.raises(UsageError, match="folder of probes"):
        find_probes(tmp_path)

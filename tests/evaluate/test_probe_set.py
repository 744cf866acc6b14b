from pathlib import Path

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.evaluate.probe_set import UNSORTED, assign_folds, find_probes
from panokit.io import write_environment_map


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


def test_a_folder_without_maps_is_refused(tmp_path: Path):
    with pytest.raises(UsageError, match="folder of probes"):
        find_probes(tmp_path)

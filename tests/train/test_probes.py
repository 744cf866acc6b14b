from pathlib import Path

import numpy as np
import pytest

from panokit.errors import RecordError, StorageError
from panokit.train.probes import TrainingProbe, assign_folds, read_probes


def probe(name: str, category: str, group: str) -> TrainingProbe:
    return TrainingProbe(
        name=name, path=Path(name), category=category, group=group, sha256="0" * 64
    )


def test_only_probes_for_training_are_read(probe_folder: Path):
    probes = read_probes(probe_folder)
    assert [probe.name for probe in probes] == [f"map{i}" for i in range(5)]
    assert {probe.category for probe in probes} == {"indoor", "outdoor"}
    assert probes[0].radiance().shape == (512, 1024, 3)


def test_a_group_is_never_split_and_a_category_is_spread():
    probes = [probe(f"{c}{i}", c, f"{c}{i // 2}") for c in ("sky", "room") for i in range(20)]
    folds = assign_folds(probes, 5)
    assert set(folds) == set(range(5))
    for group in {p.group for p in probes}:
        assert len({f for p, f in zip(probes, folds, strict=True) if p.group == group}) == 1
    for category in ("sky", "room"):
        mine = [f for p, f in zip(probes, folds, strict=True) if p.category == category]
        assert np.bincount(mine, minlength=5).tolist() == [4] * 5


def test_a_folder_without_a_manifest_and_one_without_probes_are_refused(tmp_path: Path):
    with pytest.raises(StorageError, match=r"manifest\.csv"):
        read_probes(tmp_path)
    manifest = tmp_path / "manifest.csv"
    manifest.write_text("name,path\nx,y\n", encoding="utf-8")
    with pytest.raises(RecordError, match="line 2: there is no `file`"):
        read_probes(tmp_path)
    manifest.write_text("name,file\nx,y.exr\n", encoding="utf-8")
    with pytest.raises(StorageError, match=r"y\.exr"):
        read_probes(tmp_path)
    manifest.write_text("name,file,category,split_group,usable_for,sha256\n", encoding="utf-8")
    with pytest.raises(RecordError, match="no probe"):
        read_probes(tmp_path)

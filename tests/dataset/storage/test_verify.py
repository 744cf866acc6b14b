import json

import numpy as np
import pytest

from panokit.dataset.storage.decode import decode_member
from panokit.dataset.storage.index import index_shards, read_index, write_index
from panokit.dataset.storage.layout import DatasetFolder
from panokit.dataset.storage.members import exr_bytes
from panokit.dataset.storage.sample_checks import check_member, check_views
from panokit.dataset.storage.shards import read_members, tar_bytes, write_shard
from panokit.dataset.storage.verify import check_splits, verify_dataset
from panokit.errors import StorageError
from panokit.io.files import file_entry, read_json, write_json
from panokit.io.images import encode_png
from tests.dataset.conftest import COUNT
from tests.dataset.fake import WIDTH_PX, FakeMaker


def rewrite(folder, change, shard="train-00000"):
    """Write a shard anew with changed members, as a renderer with a fault would have."""
    path = DatasetFolder(folder).shards / f"{shard}.tar"
    data = path.read_bytes()
    samples = {}
    for member in read_members(path):
        content = data[member.offset : member.offset + member.bytes]
        samples.setdefault(member.key, {})[member.name] = content
    for key, members in samples.items():
        change(key, members)
    write_shard(path, [tar_bytes(key, members) for key, members in samples.items()])
    record = read_json(path.with_suffix(".json"))
    write_json(path.with_suffix(".json"), record | {"files": {path.name: file_entry(path)}})
    shards = DatasetFolder(folder).complete_shards()
    write_index(index_shards(shards), DatasetFolder(folder).index)
    return min(samples)


def reasons(folder):
    return {problem.reason for problem in verify_dataset(folder).problems}


def test_a_good_dataset_has_no_problems(finished_dataset):
    found = verify_dataset(finished_dataset)
    assert found.problems == ()
    assert (found.samples, found.shards, found.missing) == (COUNT, 6, 0)


def test_a_changed_byte_is_found(own_dataset):
    shard = own_dataset / "shards" / "train-00001.tar"
    data = bytearray(shard.read_bytes())
    member = next(m for m in read_members(shard) if m.name == "left.png")
    data[member.offset + 30] ^= 255
    shard.write_bytes(data)
    found = verify_dataset(own_dataset).problems
    assert {p.reason for p in found} >= {"digest"}
    assert found[0].place == "train-00001.tar"


def test_a_cut_shard_and_a_missing_record_are_found(own_dataset):
    shards = own_dataset / "shards"
    (shards / "train-00000.tar").write_bytes((shards / "train-00000.tar").read_bytes()[:9000])
    (shards / "test-00000.json").unlink()
    found = verify_dataset(own_dataset)
    assert {p.reason for p in found.problems} >= {
        "digest", "damaged-shard", "no-record", "not-in-shards",
    }  # fmt: skip
    assert found.missing > 8


FLAT = np.zeros((WIDTH_PX, WIDTH_PX, 3), np.float32)
CASES = {
    "not-unit": {"left_normal.exr": exr_bytes(FLAT + 0.5, half=True)},
    "not-finite": {"env64.exr": exr_bytes(np.full((64, 64, 3), np.nan))},
    "negative": {"env.exr": exr_bytes(np.full((64, 128, 3), -1.0))},
    "dark": {"env64.exr": exr_bytes(np.zeros((64, 64, 3)))},
    "wrong-size": {"right.png": encode_png(np.zeros((8, 8, 3), np.uint8))},
    "wrong-channels": {"left_mask.png": encode_png(np.zeros((WIDTH_PX, WIDTH_PX, 3), np.uint8))},
    "blank-mask": {"left_mask.png": encode_png(np.zeros((WIDTH_PX, WIDTH_PX), np.uint8))},
    "truncated": {"left.png": b"not a picture"},
    "unknown-member": {"left.txt": b"hello"},
    "mask-and-normal": {"right_mask.png": encode_png(np.full((WIDTH_PX, WIDTH_PX), 255, np.uint8))},
    "depth-and-normal": {
        "left_depth.exr": exr_bytes(np.ones((WIDTH_PX, WIDTH_PX)), half=True),
    },
}


@pytest.mark.parametrize("reason", CASES)
def test_members_that_are_not_what_they_should_be(own_dataset, reason):
    def spoil(key, members):
        if key == "000000000":
            members |= CASES[reason]

    rewrite(own_dataset, spoil)
    found = verify_dataset(own_dataset).problems
    assert reason in {p.reason for p in found}
    name = next(iter(CASES[reason]))
    assert f"train-00000.tar/000000000.{name}" in {p.place for p in found}


def test_a_missing_member_and_a_sample_of_another_split(own_dataset):
    def spoil(key, members):
        meta = json.loads(members["meta.json"])
        if key == "000000000":
            del members["right_depth.exr"]
        if key == "000000001":
            members["meta.json"] = json.dumps(meta | {"split": "test"}).encode()

    rewrite(own_dataset, spoil)
    assert reasons(own_dataset) >= {"no-member", "split"}


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("probe", "place"), "test-place-0"),
        (("object", "id"), "test-chair-1"),
        (("probe", "sha256"), "test-map-2"),
        (("object", "sha256"), "test1"),
    ],
)
def test_splits_that_share_something_by_name_or_by_content(own_dataset, path, value):
    used = [FakeMaker().make(i, 0).meta for i in range(COUNT)]
    other = {m[path[0]][path[1]] for m in used if m["split"] == "test"}
    value = value if value in other else min(other)

    def spoil(key, members):
        meta = json.loads(members["meta.json"])
        meta[path[0]][path[1]] = value
        members["meta.json"] = json.dumps(meta).encode()

    rewrite(own_dataset, spoil)
    overlaps = [p for p in verify_dataset(own_dataset).problems if p.reason == "split-overlap"]
    assert [p.place for p in overlaps] == [value]
    assert "is in test and train" in overlaps[0].message


def test_an_index_of_other_places_is_found(own_dataset, finished_dataset):
    import pyarrow.compute as pc
    import pyarrow.parquet as pq

    path = own_dataset / "index.parquet"
    table = pq.read_table(path)
    column = table.column_names.index("offset/left.png")
    pq.write_table(
        table.set_column(column, "offset/left.png", pc.add(table.column(column), 512)), path
    )
    assert reasons(own_dataset) == {"index-offset"}


def test_a_sample_that_is_there_twice(own_dataset):
    shards = own_dataset / "shards"
    for suffix in (".tar", ".json"):
        (shards / f"train-00009{suffix}").write_bytes(
            (shards / f"train-00000{suffix}").read_bytes()
        )
    record = read_json(shards / "train-00009.json")
    record["files"] = {"train-00009.tar": file_entry(shards / "train-00009.tar")}
    write_json(shards / "train-00009.json", record)
    assert "twice" in reasons(own_dataset)


def test_nothing_to_verify(tmp_path):
    with pytest.raises(StorageError, match="no dataset"):
        verify_dataset(tmp_path)


def test_a_table_without_overlap(finished_dataset):
    assert check_splits(read_index(finished_dataset)) == []


def test_checks_of_values_that_are_right():
    members = FakeMaker().make(0, 0).members
    values = {name: decode_member(name, data) for name, data in members.items()}
    for name, value in values.items():
        assert list(check_member(name, value, WIDTH_PX)) == []
    assert list(check_views(values)) == []
    albedo = np.full((WIDTH_PX, WIDTH_PX, 3), 1.2, np.float32)
    assert [r for r, _ in check_member("albedo.exr", albedo, WIDTH_PX)] == ["out-of-range"]
    far = np.full((WIDTH_PX, WIDTH_PX), 9e3, np.float32)
    assert [r for r, _ in check_member("left_depth.exr", far, WIDTH_PX)] == ["out-of-range"]
